"""The collapse of each trial and joint reduced to the rates that its recording leaves plausible.

Between a lowest and a highest x = log(k_v/c_v) the elastic responses need six or seven curves
instead of the thirty of the whole table. A window holds those of one such range,

    c(x) = Tᵀ c_w(x),   T the right singular vectors of the table's nodes in the range,

and the rows of a trial become one block per joint, [T U, ∫u, 1, y_j], each with weights of its own.
Between its limits the likelihood stays the same to rounding; beyond, a response goes on as it goes
beyond a table (`basis`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.population.basis import TOLERANCE
from softfinger.population.collapse import Collapse

LINEAR = 3  # ∫u, 1 and y follow a joint's curves


class Windows(NamedTuple):
    """Coefficients c_w(x) of every window, node by node, one window after the other."""

    place: NDArray[np.float64]  # (window, 2): first x, step
    begin: NDArray[np.int64]  # (window + 1,): where the nodes of a window begin
    modes: NDArray[np.int64]  # (window,): how many curves it needs
    value: NDArray[np.float64]  # (node, most modes)
    slope: NDArray[np.float64]  # (node, most modes): dc_w/dx


class LocalCollapse(NamedTuple):
    """What the likelihood is computed from; D = the most rows that a trial's joints have."""

    windows: Windows
    window: NDArray[np.int64]  # (trial, joint)
    gap: NDArray[np.float64]  # (gap,) in median intervals
    products: NDArray[np.float64]  # (gap, trial, 3, D, D): N, B, X; block after block
    first: NDArray[np.float64]  # (trial, D)
    count: NDArray[np.float64]  # (trial, gap + 1)
    offset: NDArray[np.float64]  # (trial,) [nats]
    patterns: NDArray[np.bool_]  # (pattern, joint)
    pattern: NDArray[np.int64]  # (trial,)

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which joints (trial, joint) take part."""
        return self.patterns[self.pattern]


def localise_collapse(
    collapse: Collapse,
    low: NDArray[np.float64] | float = -np.inf,
    high: NDArray[np.float64] | float = np.inf,
) -> LocalCollapse:
    """Reduce each trial's and joint's rows to those of rates between its own limits.

    Parameters
    ----------
    collapse
        What `collapse_angles` makes.
    low, high
        Limits of x (trial, joint); nodes of the table next to them are still inside.
    """
    last = len(collapse.table.value) - 1
    nodes = [
        np.clip(np.floor(_find_place(collapse, low)), 0, last - 1),
        np.clip(np.ceil(_find_place(collapse, high)), 1, last),
    ]
    ranges = np.stack(nodes, axis=-1).astype(int).reshape(-1, 2)
    distinct, window = np.unique(ranges, axis=0, return_inverse=True)
    windows, turns = _build_windows(collapse, distinct)
    window = window.reshape(collapse.present.shape)
    size = (windows.modes[window] + LINEAR).sum(axis=1)
    trials, gaps = collapse.products.shape[:2]
    products = np.zeros((gaps, trials, 3, size.max(), size.max()))
    first = np.zeros((trials, size.max()))
    for i in range(trials):
        turn = _stack_turns([turns[w] for w in window[i]])
        products[:, i, :, : size[i], : size[i]] = turn @ collapse.products[i] @ turn.T
        first[i, : size[i]] = turn @ collapse.first[i]
    rest = {name: getattr(collapse, name) for name in ("gap", *PER_TRIAL)}
    return LocalCollapse(
        windows, window, products=products, first=first, patterns=collapse.patterns, **rest
    )


PER_TRIAL = ("count", "offset", "pattern")


def _find_place(collapse: Collapse, limit: NDArray | float) -> NDArray:
    start, step = collapse.table.place
    return (np.broadcast_to(limit, collapse.present.shape) - start) / step


def _build_windows(collapse: Collapse, ranges: NDArray) -> tuple[Windows, list[NDArray]]:
    """Build the windows from ranges (window, 2) of nodes, and their T (modes, M)."""
    table = collapse.table
    turns = []
    for first, last in ranges:
        _, size, modes = np.linalg.svd(table.value[first : last + 1], full_matrices=False)
        turns.append(modes[size > TOLERANCE * size[0]])
    modes = np.array([len(turn) for turn in turns])
    begin = np.concatenate([[0], np.cumsum(ranges[:, 1] - ranges[:, 0] + 1)])
    value, slope = np.zeros((2, begin[-1], modes.max()))
    for w, ((first, last), turn) in enumerate(zip(ranges, turns, strict=True)):
        for whole, part in ((table.value, value), (table.slope, slope)):
            part[begin[w] : begin[w + 1], : modes[w]] = whole[first : last + 1] @ turn.T
    start = table.place[0] + ranges[:, 0] * table.place[1]
    place = np.column_stack([start, np.full(len(start), table.place[1])])
    return Windows(place, begin, modes, value, slope), turns


def _stack_turns(turns: list[NDArray]) -> NDArray:
    """Build the matrix (blocks' rows, D) that makes a trial's blocks from its rows of before."""
    joints, curves = len(turns), turns[0].shape[1]
    whole = np.eye(curves + 2 + joints)
    blocks = []
    for joint, turn in enumerate(turns):
        padded = np.zeros((len(turn), len(whole)))
        padded[:, :curves] = turn
        blocks += [padded, whole[[curves, curves + 1, curves + 2 + joint]]]
    return np.concatenate(blocks)
