"""A drive that softly nears its limit."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics
from softfinger.concealed.protocols import Load, refine_load


def saturate(load: Load, limit: float, power: float) -> Load:
    """Tension T / (1 + (T/limit)^p)^(1/p).

    The larger p, the harder the limit.
    """
    fine = refine_load(load, 0.25)
    tension = fine.tension / (1.0 + (fine.tension / limit) ** power) ** (1.0 / power)
    return Load(fine.time, tension)


def act(physics: Physics, load: Load) -> Physics:
    """Physics of another load."""
    return physics._replace(load_time=load.time, load_tension=load.tension)


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """The strength is the inverse of the limit [1/N]."""
    if dose.strength == 0.0:
        return physics
    load = Load(physics.load_time, physics.load_tension)
    return act(physics, saturate(load, 1.0 / dose.strength, 8.0))


EFFECT = Effect(
    id="load_limit",
    sentence="a load that is logged and not reached",
    level="within_trial",
    joints="chain",
    typical=0.12,
    largest=0.2,
    move=_move,
    tell=lambda dose, trials: {"limit": 1.0 / max(dose.strength, 1e-9)},
)


def limit_rate(load: Load, rate: float) -> Load:
    """Tension that follows by at most `rate` [N/s]."""
    fine = refine_load(load, 0.25)
    time, wanted = [float(fine.time[0])], [0.0]
    for k in range(fine.time.size):
        ends = (fine.time[k], fine.time[k + 1] if k + 1 < fine.time.size else np.inf)
        target = fine.tension[k]
        slope = 0.0
        if np.isfinite(ends[1]) and ends[1] > ends[0]:
            slope = (fine.tension[k + 1] - target) / (ends[1] - ends[0])
        _chase(time, wanted, ends, (target, slope), rate)
    return Load(np.array(time), np.array(wanted))


def _chase(
    time: list[float],
    reached: list[float],
    ends: tuple[float, float],
    line: tuple[float, float],
    rate: float,
) -> None:
    """Follow one straight piece from what was reached."""
    start, stop = ends
    gap, slope = line[0] - reached[-1], line[1]
    if stop <= start:
        return
    pace = np.copysign(rate, gap)
    if gap != 0.0 and (pace - slope) * gap > 0.0:
        meets = min(start + gap / (pace - slope), stop)
        time.append(float(meets))
        reached.append(float(reached[-1] + pace * (meets - start)))
        start = meets
    if start < stop and np.isfinite(stop):
        held = np.clip(slope, -rate, rate)
        time.append(float(stop))
        reached.append(float(reached[-1] + held * (stop - start)))
