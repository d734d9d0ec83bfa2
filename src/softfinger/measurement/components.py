"""Which components of a measurement are present.

They are chosen by evidence, one after the other.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from softfinger.measurement.budget import BUDGET
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.priors import PRIORS

Sizes = dict[str, float]
Climb = Callable[[Mapping[str, float]], tuple[float, Mapping[str, float]]]


def choose_components(
    evaluate: Callable[[Mapping[str, float]], float],
    sizes: Mapping[str, NDArray[np.float64]],
    least: float = DECISIONS.present_nats,
    is_plausible: Callable[[str, float], bool] = lambda *_: True,
    most: int | None = None,
    climb: Climb | None = None,
) -> tuple[Sizes, Sizes]:
    """Choose components and their sizes.

    A component's evidence is averaged over its possible sizes; the best one joins while it gains
    `least`, and then the sizes of all are sought. What asks for more than is plausible in the end
    is no such component, and they are chosen again without it.

    Parameters
    ----------
    evaluate
        Component → size, to the log evidence [nats]; components not named are absent.
    sizes
        Component → the sizes (n,) that it may have.
    least
        Evidence [nats] from which a component is there.
    is_plausible
        Whether a component may have a size.
    most
        Components after which no further one is sought.
    climb
        Component → size, to the evidence [nats] and its slopes by the logs of the sizes: with it
        sizes are sought; None: with `evaluate`, by differences.

    Returns
    -------
    size, evidence
        Component → size, and evidence [nats] beside the others; only those that are there.

    Examples
    --------
    >>> def evaluate(size):
    ...     return -(np.log(size["a"]) ** 2) if "a" in size else -20.0
    >>> size, _ = choose_components(evaluate, {"a": np.array([0.5, 2.0]), "b": np.ones(1)})
    >>> list(size), round(size["a"], 1)
    (['a'], 1.0)
    """
    known: dict[frozenset, float] = {}

    def look_up(size: Mapping[str, float]) -> float:
        key = frozenset(size.items())
        if key not in known:
            known[key] = evaluate(size)
        return known[key]

    if not np.isfinite(look_up({})):
        return {}, {}
    while True:
        size, evidence = _choose(look_up, sizes, least, len(sizes) if most is None else most, climb)
        plausible = {name for name in size if is_plausible(name, size[name])}
        if len(plausible) == len(size):
            return size, evidence
        sizes = {name: s for name, s in sizes.items() if name in plausible or name not in size}


def _choose(
    evaluate: Callable[[Mapping[str, float]], float],
    sizes: Mapping[str, NDArray[np.float64]],
    least: float,
    most: int,
    climb: Climb | None,
) -> tuple[Sizes, Sizes]:
    size: Sizes = {}
    absent = list(sizes)
    while absent and len(size) < most:
        gain = {name: _weigh(evaluate, size, name, sizes[name]) for name in absent}
        name = max(gain, key=lambda name: gain[name])
        if gain[name] < least:
            break
        # beside another, none gains that did not gain without it
        absent = [other for other in absent if other != name and gain[other] > 0.0]
        before = dict(size)
        size[name] = max(map(float, sizes[name]), key=lambda s: evaluate(before | {name: s}))
        size = _refine(evaluate, size, sizes, climb)
    evidence = {}
    for name in size:
        rest = {key: value for key, value in size.items() if key != name}
        evidence[name] = _weigh(evaluate, rest, name, sizes[name])
    return size, evidence


def _weigh(
    evaluate: Callable[[Mapping[str, float]], float],
    size: Sizes,
    name: str,
    sizes: NDArray[np.float64],
) -> float:
    """Evidence [nats] for one component, averaged over its sizes."""
    values = [evaluate(size | {name: float(s)}) for s in sizes]
    return float(np.logaddexp.reduce(values) - np.log(len(values)) - evaluate(size))


def is_at_bound(size: float, sizes: NDArray[np.float64]) -> bool:
    """Whether a size that was sought ends where it had to.

    >>> is_at_bound(0.0399, np.array([0.01, 0.02])), is_at_bound(0.03, np.array([0.01, 0.02]))
    (True, False)
    """
    return bool(size > (1.0 - BUDGET.size_digits) * PRIORS.beyond * max(sizes))


def _refine(
    evaluate: Callable[[Mapping[str, float]], float],
    size: Sizes,
    sizes: Mapping[str, NDArray[np.float64]],
    climb: Climb | None,
) -> Sizes:
    """Seek the best sizes, none beyond twice what it may be.

    What asks for more is not this component.
    """
    names, start = list(size), evaluate(size)

    def put(x: NDArray[np.float64]) -> Sizes:
        return {name: round(float(np.exp(log)), 9) for name, log in zip(names, x, strict=True)}

    def descend(x: NDArray[np.float64]) -> tuple[float, list[float]]:
        value, slope = climb(put(x))
        return start - value, [-slope[name] for name in names]

    found = minimize(
        descend if climb else lambda x: start - evaluate(put(x)),  # of the size of what is gained
        np.log([size[name] for name in names]),
        jac=climb is not None,
        method="L-BFGS-B",
        bounds=[
            tuple(np.log([min(sizes[name]) / PRIORS.beyond, PRIORS.beyond * max(sizes[name])]))
            for name in names
        ],
        options={"eps": BUDGET.size_digits, "ftol": 3e-3, "maxfun": BUDGET.evaluations},
    )
    return max(size, put(found.x), key=evaluate)
