"""Further Voigt elements with which a body follows its recordings.

A real body creeps on many time scales. An effect that is added to three elements alone would be an
effect of another body: half the load on it would not halve the recorded motion. So each trial is
fitted once more, by the three elements with the delay that they have alone and a ladder of other
delays. No compliance is negative; a gross error hardly counts.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import lsq_linear

from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances
from softfinger.concealed.forward import compute_plain_angles

SPACING = 4.0  # between the delays of neighbouring elements
RIGID = np.log(1e12)
ROUNDS = 6
LEAST_SHARE = 0.1  # of the largest element's compliance that the own delay keeps
LEAST_PART = 1e-6  # of the largest part of the motion that an element must have
SETTLED = 0.3  # longest delay, as a share of the trial, of an element that settles


class Ladder(NamedTuple):
    """Compliances (element, 1) [rad/(N m)] and delays (element,) [s]."""

    compliance: Array
    retardation_time: Array


NO_LADDER = Ladder(np.zeros((0, 1)), np.zeros(0))


def fit_ladder(
    own: Array, trial: Circumstances, wire_offset: float, time: Array, motion: Array, close: float
) -> tuple[Array, Ladder]:
    """Fit the three elements and a ladder to one trial.

    Parameters
    ----------
    own : array (4, 1)
        Three elements that come close: log k_v, log c_v, log c_p and q_ini.
    time, motion : array (row,)
        Of the finite frames.
    close : float [rad]
        Residual from which a frame counts less.

    Returns
    -------
    own, ladder
        The Voigt element of the three is the largest one that settles, where its delay alone has
        next to nothing left. As they were where there is none: the motion is all flow.
    """
    delay = float(np.exp(own[1, 0] - own[0, 0]))
    gap = np.diff(np.unique(time))
    delays = list_delays(delay, float(gap.min()), float(gap.sum()))

    def respond(k_v: float, c_v: float, c_p: float) -> Array:
        element = np.array([[k_v], [c_v], [c_p], [0.0]])
        return compute_plain_angles(element, trial, wire_offset, time)[:, 0]

    columns = [respond(0.0, np.log(one), RIGID) for one in (delay, *delays)]
    columns += [respond(RIGID, RIGID, 0.0), np.ones(time.size)]
    design = np.stack(columns, axis=1)
    size = np.maximum(np.abs(design).max(axis=0), np.finfo(float).tiny)
    low = np.append(np.zeros(len(columns) - 1), -np.inf)
    weight = np.ones(time.size)
    for _ in range(ROUNDS):
        part = lsq_linear(design / size * weight[:, None], motion * weight, (low, np.inf)).x
        weight = (1.0 + ((motion - design @ (part / size)) / close) ** 2) ** -0.25
    part[:-1] *= part[:-1] >= LEAST_PART * np.abs(part).max()  # a bound is reached nearly
    *steps, flow, rest = part / size
    steps, delays = np.array(steps), np.array([delay, *delays])
    settled = np.where(delays < SETTLED * gap.sum(), steps, 0.0)
    main = 0 if steps[0] >= LEAST_SHARE * settled.max() else int(settled.argmax())
    if steps[main] <= 0.0:
        return own, NO_LADDER
    k_v, c_p = -np.log(steps[main]), -np.log(max(flow, np.exp(-RIGID)))
    kept = (steps > 0.0) & (np.arange(steps.size) != main)
    return (
        np.array([[k_v], [k_v + np.log(delays[main])], [c_p], [rest]]),
        Ladder(steps[kept, None], delays[kept]),
    )


def list_delays(own: float, shortest: float, longest: float) -> list[float]:
    """List the delays of a ladder about the own one.

    >>> list_delays(1.0, 0.1, 20.0)
    [0.25, 4.0, 16.0]
    """
    below = int(max(np.log(own / shortest) / np.log(SPACING), 0.0))
    above = int(max(np.log(longest / own) / np.log(SPACING), 0.0))
    return [own * SPACING**k for k in range(-below, above + 1) if k]
