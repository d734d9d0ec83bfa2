"""How the size of the noise differs.

It differs between trials and joints, with the deflection, and with the speed.

The noise of joint j in trial t is that of the campaign times e^{b_tj/2} √(1 + c² x² + a² v²), x
being how far the joint is from where it began, and v how fast it moves. Each quiet window's
variance s² (ν degrees of freedom) measures it: log s² is all but normal about the truth, with
variance 4/ν-like ψ'(ν/2), more where the noise has heavy tails. The b are normal, with a part that
all joints of a trial share; windows may scatter by more than chance. The evidence of every
component is averaged over sizes; a component is left out where it gains less than `present_nats`.

References
----------
Bartlett, Kendall (1946), Suppl. J. R. Stat. Soc. 8, 128: the logarithm of a sample variance.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, polygamma

from softfinger.measurement.components import choose_components
from softfinger.measurement.priors import PRIORS

Array = NDArray[np.float64]

SIZES: Mapping[str, Array] = {
    "trial": np.array(PRIORS.uneven_sizes),
    "cell": np.array(PRIORS.uneven_sizes),
    "signal": np.array(PRIORS.signal_sizes),
    "rate": np.array(PRIORS.signal_sizes),
}
UNKNOWN = 1e6  # variance of what no window measures


class WindowVariances(NamedTuple):
    """What quiet windows show of the noise.

    Attributes
    ----------
    value, freedom
        (window,) variance over that of the campaign's noise; degrees of freedom.
    trial, joint
        (window,) places.
    deflection, speed
        (window,) [rad], [rad/s].
    trials, joints
        How many there are.
    expected
        Whether a variance of 1 is expected, because it is declared.
    """

    value: Array
    freedom: Array
    trial: NDArray[np.int64]
    joint: NDArray[np.int64]
    deflection: Array
    speed: Array
    trials: int
    joints: int
    expected: bool = False


class Scales(NamedTuple):
    """Size of the noise relative to the campaign's.

    Attributes
    ----------
    factor
        (trial, joint).
    per_rad, per_rate
        c [1/rad] and a [s/rad]; 0 where the noise does not grow.
    fastest
        [rad/s] of the windows; how noise grows beyond that they do not show.
    size, evidence
        Component → size, and evidence [nats]; only those that are present.
    """

    factor: Array
    per_rad: float
    per_rate: float
    fastest: float
    size: dict[str, float]
    evidence: dict[str, float]

    def rename_rate(self, name: str) -> "Scales":
        """The same, what grows with the speed by another name."""
        size, evidence = (
            {name if one == "rate" else one: value for one, value in part.items()}
            for part in (self.size, self.evidence)
        )
        return self._replace(size=size, evidence=evidence)


def fit_scales(windows: WindowVariances) -> Scales:
    """Find the components that the windows show.

    Also their sizes, and each trial's and joint's factor.

    Examples
    --------
    Windows that scatter no more than they should show nothing.

    >>> n = np.arange(40)
    >>> moved = 0.1 * n, 0.2 * n
    >>> even = WindowVariances(np.ones(40), np.full(40, 100.0), n // 8, n % 2, *moved, 5, 2)
    >>> fit_scales(even).size
    {}
    """
    sizes = {name: grid for name, grid in SIZES.items() if _is_testable(windows, name)}
    size, evidence = choose_components(lambda some: _evaluate(windows, some), sizes)
    factor = np.exp(0.5 * _locate(windows, size))
    largest, fastest = (float(x.max(initial=0.0)) for x in (windows.deflection, windows.speed))
    per_rad = size["signal"] / largest if "signal" in size else 0.0
    per_rate = size["rate"] / fastest if "rate" in size else 0.0
    return Scales(factor, per_rad, per_rate, fastest, size, evidence)


def _is_testable(windows: WindowVariances, name: str) -> bool:
    if not len(windows.value):
        return False
    if name == "trial":
        return windows.trials > 1
    if name == "cell":
        return windows.trials > 1 and windows.joints > 1
    return bool(np.ptp(windows.deflection if name == "signal" else windows.speed) > 0)


def _evaluate(windows: WindowVariances, size: Mapping[str, float]) -> float:
    """Log evidence at given sizes.

    The windows' own scatter is averaged out.
    """
    values = [_solve(windows, size, scatter)[0] for scatter in PRIORS.window_scatter]
    return float(np.logaddexp.reduce(values) - np.log(len(values)))


def _locate(windows: WindowVariances, size: Mapping[str, float]) -> Array:
    """Posterior mean of b (trial, joint).

    The scatter of the windows is the most probable one.
    """
    solved = [_solve(windows, size, scatter) for scatter in PRIORS.window_scatter]
    return max(solved, key=lambda one: one[0])[1]


def _solve(
    windows: WindowVariances, size: Mapping[str, float], scatter: float
) -> tuple[float, Array]:
    """Log evidence, and posterior mean of b (trial, joint).

    Each joint's level is integrated out.

    Where a level is expected, b has it.
    """
    trials, joints = windows.trials, windows.joints
    half = 0.5 * windows.freedom
    growth = np.zeros(len(half))
    for name, moved in (("signal", windows.deflection), ("rate", windows.speed)):
        largest = max(float(moved.max(initial=0.0)), 1e-300)
        growth += (size.get(name, 0.0) * moved / largest) ** 2
    value = np.log(windows.value) - digamma(half) + np.log(half) - np.log1p(growth)
    precision = 1.0 / (polygamma(1, half) + scatter**2)
    place = windows.trial * joints + windows.joint
    weight = np.bincount(place, precision, trials * joints)
    mean = np.bincount(place, precision * value, trials * joints) / np.maximum(weight, 1e-300)
    within = np.sum(precision * (value - mean[place]) ** 2 - np.log(precision))
    own = np.where(weight > 0, 1.0 / np.maximum(weight, 1e-300), UNKNOWN)
    within -= np.log(own[weight > 0]).sum()
    own, mean = own.reshape(trials, joints), mean.reshape(trials, joints)
    shared, apart = 4.0 * size.get("trial", 0.0) ** 2, 4.0 * size.get("cell", 0.0) ** 2
    between = shared * np.ones((joints, joints)) + apart * np.eye(joints)
    inverse = np.linalg.inv(between + own[:, :, None] * np.eye(joints))
    normal = inverse.sum(axis=0)
    if windows.expected:
        normal += np.eye(joints) / (2.0 * PRIORS.declared_sd) ** 2
    level = np.linalg.solve(normal, np.einsum("tjk,tk->j", inverse, mean))
    left = mean - level
    pull = np.einsum("tjk,tk->tj", inverse, left)
    square = np.sum(left * pull) - np.linalg.slogdet(inverse)[1].sum()
    square += np.linalg.slogdet(normal)[1]
    return -0.5 * float(within + square), pull @ between + (level if windows.expected else 0.0)
