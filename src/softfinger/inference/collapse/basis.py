"""Basis of curves for the elastic responses of trials.

The exact collapse uses it; a dozen curves suffice.

The elastic response e(t; x), x = log(k_v/c_v), is an integral of exp(−eˣ (t − s)) over the load, so
over any finite set of times its curves lie, to rounding, in a space of few dimensions:

    e(t; x) = Σ_m c_m(x) U_m(t)

The coefficients c_m belong to the whole campaign: they come from the singular value decomposition
of curves at Chebyshev places of x, and are kept as a cubic Hermite table with exact slopes. The
curves U_m belong to one trial's times and load. Outside of the table e has its limits: in
proportion to eˣ below (rate · duration ≤ 0.02), and constant above (20 retardation times a frame).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.budget import BUDGET
from softfinger.mechanics.three_element import compute_elastic_basis_array

TOLERANCE = 1e-10  # of the largest singular value

Protocol = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


class ElasticTable(NamedTuple):
    """Coefficients c(x) and slopes on an even grid."""

    place: NDArray[np.float64]  # (2,): first x, step
    value: NDArray[np.float64]  # (node, mode)
    slope: NDArray[np.float64]  # (node, mode)

    @property
    def nodes(self) -> NDArray[np.float64]:
        """The grid of x (node,)."""
        return self.place[0] + self.place[1] * np.arange(len(self.value))


def build_elastic_table(protocols: list[Protocol]) -> ElasticTable:
    """Build the coefficients that serve every protocol.

    Parameters
    ----------
    protocols
        The distinct (time, load_time, load_torque) of the campaign; time without NaN,
        increasing.
    """
    duration = max(time[-1] - min(load[0], time[0]) for time, load, _ in protocols)
    interval = min(np.median(np.diff(time)) for time, _, _ in protocols)
    low, high = np.log(BUDGET.slowest / duration), np.log(BUDGET.fastest / interval)
    chosen = np.linspace(0, len(protocols) - 1, min(len(protocols), BUDGET.table_protocols)).astype(
        int
    )
    places = place_curves_array(low, high)
    curves = np.hstack([_evaluate(places, protocols[i])[0] for i in chosen])
    _, size, modes = np.linalg.svd(curves, full_matrices=False)
    modes = modes[size > TOLERANCE * size[0]]
    nodes = np.linspace(low, high, int(np.ceil((high - low) / BUDGET.table_step)) + 1)
    value, slope = _project(nodes, [protocols[i] for i in chosen], modes)
    return ElasticTable(np.array([low, nodes[1] - nodes[0]]), value, slope)


def build_elastic_modes(table: ElasticTable, protocol: Protocol) -> NDArray[np.float64]:
    """Build one protocol's U (mode, n) [N m]."""
    places = place_curves_array(*table.nodes[[0, -1]])
    coefficients = np.stack([interpolate_coefficients_array(table, x)[0] for x in places])
    curves, _ = _evaluate(places, protocol)
    return np.linalg.lstsq(coefficients, curves, rcond=1e-14)[0]


def place_curves_array(low: float, high: float) -> NDArray[np.float64]:
    """Place BUDGET.curves Chebyshev points between low and high.

    >>> x = place_curves_array(-1.0, 1.0)
    >>> len(x), bool(x[0] > -1.0), bool(abs(x.sum()) < 1e-12)
    (96, True, True)
    """
    angle = (np.arange(BUDGET.curves) + 0.5) * np.pi / BUDGET.curves
    return 0.5 * (low + high) - 0.5 * (high - low) * np.cos(angle)


def interpolate_coefficients_array(
    table: ElasticTable, log_rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interpolate c(x) and dc/dx (mode,) at x = log(k_v/c_v)."""
    modes = table.value.shape[1]
    value, slope = np.empty(modes), np.empty(modes)
    fill_coefficients(log_rate, *table, 0, len(table.value) - 1, modes, value, slope)
    return value, slope


@compiled(error_model="numpy")
def fill_coefficients(
    x: float,
    place: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    first: int,
    last: int,
    modes: int,
    value: NDArray,
    slope: NDArray,
) -> None:
    """Write c(x) and dc/dx into `value` and `slope`.

    The table's nodes are those from `first` to `last`; the first lies at `place[0]`.
    """
    step = place[1]
    where = (x - place[0]) / step
    if not where > 0.0:  # NaN as well
        share = np.exp(x - place[0])
        for m in range(modes):
            value[m] = table_value[first, m] * share
            slope[m] = value[m]
        return
    if where >= last - first:
        for m in range(modes):
            value[m] = table_value[last, m]
            slope[m] = 0.0
        return
    s = where - int(where)
    k = first + int(where)
    r = 1.0 - s
    h00, h01 = (1.0 + 2.0 * s) * r * r, s * s * (3.0 - 2.0 * s)
    h10, h11 = s * r * r * step, -s * s * r * step
    d00 = -6.0 * s * r / step
    d10, d11 = r * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)
    for m in range(modes):
        a, b = table_value[k, m], table_value[k + 1, m]
        da, db = table_slope[k, m], table_slope[k + 1, m]
        value[m] = h00 * a + h01 * b + h10 * da + h11 * db
        slope[m] = d00 * (a - b) + d10 * da + d11 * db


def _evaluate(x: NDArray, protocol: Protocol) -> tuple[NDArray, NDArray]:
    return compute_elastic_basis_array(np.exp(x), *protocol)


def _project(nodes: NDArray, protocols: list[Protocol], modes: NDArray) -> tuple[NDArray, NDArray]:
    value = np.zeros((len(nodes), len(modes)))
    slope = np.zeros_like(value)
    begin = 0
    for protocol in protocols:
        part = modes[:, begin : begin + len(protocol[0])]
        begin += len(protocol[0])
        curves, slopes = _evaluate(nodes, protocol)
        value += curves @ part.T
        slope += slopes @ part.T
    return value, slope
