"""A trial as it would be recorded without noise."""

from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances, Dose
from softfinger.concealed.kernel import simulate_angles
from softfinger.concealed.physics import build_plain_physics
from softfinger.concealed.population import to_parameters
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.rig import Rig

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)  # parts a circle most evenly


def simulate_trial(
    individual: Array,
    doses: dict[str, Dose],
    trial: Circumstances,
    rig: Rig,
    time: Array,
    tolerance: float = 5e-9,
    beside: tuple[Array, Array] | None = None,
) -> Array:
    """Joint angles of a trial, free of noise.

    Recorded angles (frame, joint) [rad].

    Parameters
    ----------
    individual : array (parameter, joint)
        log k_v, log c_v, log c_p, q_ini.
    doses
        The effects that are switched on, by id; any number of them at once.
    trial, rig
        What is special about the trial; the finger and its camera.
    time : array (frame,) [s]
        When the frames were taken, by the recording's clock.
    tolerance : float [rad]
        Error of one step of the integrator.
    beside
        Compliances (element, joint) [rad/(N m)] and delays (element,) [s] of Voigt elements that
        the joints have beside the three, whatever effects are switched on.
    """
    physics = build_plain_physics(
        to_parameters(individual),
        trial.load.time,
        trial.load.tension,
        rig.link_length,
        rig.link_mass,
        rig.wire_offset,
        rig.joint_length,
    )
    if beside is not None:
        physics = physics._replace(compliance=beside[0], retardation_time=beside[1])
    seen_at = time
    doses = vary(doses, trial)
    for name, dose in doses.items():
        effect = EFFECTS[name]
        if effect.move:
            physics = effect.move(physics, dose, trial)
        if effect.clock:
            seen_at = effect.clock(seen_at, dose, trial)
    angle = simulate_angles(physics, seen_at, tolerance)
    for name, dose in doses.items():
        record = EFFECTS[name].record
        if record:
            angle = record(angle, seen_at, dose, trial, rig)
    return angle


def vary(doses: dict[str, Dose], trial: Circumstances) -> dict[str, Dose]:
    """Doses of one trial, scattered about the campaign's.

    A strength is multiplied by e^(s z), s its scatter and z normal.

    Every effect has numbers of its own, from the trial's luck.
    """
    varied = {}
    for place, (name, dose) in enumerate(doses.items()):
        strength = dose.strength
        if dose.scatter:
            share = (trial.luck[2] + GOLDEN * place) % 1.0
            strength *= float(np.exp(dose.scatter * ndtri(0.002 + 0.996 * share)))
        varied[name] = replace(dose, strength=strength)
    return varied


def compute_plain_angles(
    individual: Array, trial: Circumstances, wire_offset: float, time: Array
) -> Array:
    """Joint angles of the three elements alone.

    They are (frame, joint) [rad], in closed form.

    Between two knots the torque is u + s t. The Voigt strain goes to (u + s t − s c_v/k_v)/k_v as
    e^(−t k_v/c_v), and the dashpot moves by (u t + s t²/2)/c_p.
    """
    k_v, c_v, c_p, q_ini = to_parameters(individual)
    torque = wire_offset * trial.load.tension
    knot = np.append(trial.load.time, max(time[-1], trial.load.time[-1]))
    angle = np.tile(q_ini, (time.size, 1))
    voigt, dashpot = np.zeros_like(k_v), np.zeros_like(k_v)
    for k, start in enumerate(trial.load.time):
        span = knot[k + 1] - start
        last = k + 1 == torque.size
        slope = 0.0 if last or span <= 0 else (torque[k + 1] - torque[k]) / span
        inside = (time > start) & ((time <= knot[k + 1]) | last)
        t = np.append(time[inside] - start, span)[:, None]
        drift = (torque[k] + slope * (t - c_v / k_v)) / k_v
        strain = drift + (voigt - (torque[k] - slope * c_v / k_v) / k_v) * np.exp(-k_v / c_v * t)
        flown = dashpot + (torque[k] * t + 0.5 * slope * t**2) / c_p
        angle[inside] += strain[:-1] + flown[:-1]
        voigt, dashpot = strain[-1], flown[-1]
    return angle
