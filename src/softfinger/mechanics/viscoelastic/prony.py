"""Networks of springs and dashpots, exactly.

C(s) = a + Σ b_i/(s + r_i) with all b_i > 0, r_i ≥ 0.

Such sums add; and if C is one then so is S/s = 1/(s C), whose poles lie one in each gap between
those of C, where a monotone function changes sign. So a network is reduced by additions and by
bracketed roots alone: exact to rounding.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from softfinger.mechanics.viscoelastic.elements import Dashpot, Element, Network, Spring


class Prony(NamedTuple):
    """F(s) = constant + Σ weight/(s + rate).

    Rates are ascending and different.
    """

    constant: float
    weight: NDArray[np.float64]
    rate: NDArray[np.float64]


def expand_compliance(element: Element) -> Prony:
    """Expand the compliance.

    J(t) = constant + Σ weight (1 − e^{−rate t})/rate.

    Without springpots. A rate of 0 is flow, with weight 1/damping.
    """
    if isinstance(element, Spring):
        return Prony(1.0 / element.stiffness, np.empty(0), np.empty(0))
    if isinstance(element, Dashpot):
        return Prony(0.0, np.array([1.0 / element.damping]), np.zeros(1))
    if isinstance(element, Network) and element.kind == "series":
        return _add([expand_compliance(part) for part in element.parts])
    return _invert(expand_stiffness(element))


def expand_stiffness(element: Element) -> Prony:
    """Expand the stiffness over s.

    G(t) = constant · impulse + Σ weight e^{−rate t}.

    Without springpots. A rate of 0 is the stiffness that remains for ever.
    """
    if isinstance(element, Network) and element.kind == "parallel":
        return _add([expand_stiffness(part) for part in element.parts])
    return _invert(expand_compliance(element))


def _add(terms: list[Prony]) -> Prony:
    """Add sums, equal rates into one."""
    weight = np.concatenate([term.weight for term in terms])
    rate, place = np.unique(np.concatenate([term.rate for term in terms]), return_inverse=True)
    constant = sum(term.constant for term in terms)
    return Prony(constant, np.bincount(place, weight, rate.size), rate)


def _invert(term: Prony) -> Prony:
    """Turn F into 1/(s F).

    s F = a s + Σ b − Σ b r/(s + r) rises between its poles; at its zeros s = −x the residue of
    1/(s F) is 1/(a + Σ b r/(r − x)²).
    """
    constant, weight, rate = term
    roots = [] if rate.size > 0 and rate[0] == 0.0 else [0.0]
    bounded = rate.size if constant > 0.0 else rate.size - 1
    roots = np.array(roots + [_find_zero(term, gap) for gap in range(bounded)])
    gaps = rate - roots[:, None]
    slope = (np.divide(weight * rate, gaps**2, where=rate > 0.0, out=0.0 * gaps)).sum(-1)
    return Prony(0.0 if constant > 0.0 else 1.0 / weight.sum(), 1.0 / (constant + slope), roots)


def _find_zero(term: Prony, gap: int) -> float:
    """Find a root after a pole.

    x in the gap solves a + Σ b/(r − x) = 0; it is measured from the nearer end.

    Between the poles the function rises from −∞ to +∞, after the last one to a > 0; times the
    distances to the poles at the ends of the gap it is finite.
    """
    constant, weight, rate = term
    last = gap == rate.size - 1
    width = 2.0 * weight.sum() / constant if last else rate[gap + 1] - rate[gap]
    others = np.ones(rate.size, bool)
    others[gap : gap + 2] = False

    def balance(step: float, origin: float) -> float:
        distance = (rate - origin) - step
        before, after = -distance[gap], 1.0 if last else distance[gap + 1]
        rest = constant + (weight[others] / distance[others]).sum()
        total = rest * before * after - weight[gap] * after
        return total if last else total + weight[gap + 1] * before

    low_half = balance(width / 2.0, rate[gap]) > 0.0
    origin = rate[gap] if low_half or last else rate[gap + 1]
    ends = (0.0, width) if last else (0.0, width / 2.0) if low_half else (-width / 2.0, 0.0)
    step = brentq(balance, *ends, args=(origin,), xtol=1e-300, rtol=4 * np.finfo(float).eps)
    return origin + step
