"""A finger that moves with an effect and without."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.mechanics.effects.effect import Effect, Form, Setting
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays, build_slots
from softfinger.mechanics.geometry import FingerGeometry

TRIALS, JOINTS, FRAMES, DURATION_S = 6, 3, 401, 8.0
LARGEST_NM = 0.04
OWN = np.array([[-2.4, -3.7, 2.9, 0.02], [-2.3, -3.6, 3.1, 0.02], [-1.9, -3.9, 3.3, 0.02]])
"""(joint, 4) log k_v, log c_v, log c_p, q_ini of the paper's finger, about."""
LOAD_TIME_S = np.array([0.0, 0.0, 3.0, 4.5, 6.0, 6.0, DURATION_S])
LOAD_SHARE = np.array([0.0, 0.3, 1.0, 1.0, 0.4, 0.1, 0.1])
"""A jump, a ramp, a plateau, the way back and rest."""


STRENGTHS = 2.0 ** np.arange(7)
SEEN = 0.1  # of the largest angle: a change that a small picture shows


def demonstrate_effect(effect: Effect) -> xr.Dataset:
    """Move a finger with an effect and without.

    Its amplitudes are one sd of their priors, or as many of `STRENGTHS` as it takes to be seen; all
    else is at its prior mean.

    Returns
    -------
    joint_angle (model, trial, joint, frame) [rad] with model `without` and `with`; load (frame,)
    [N m]; time (frame,) [s]. Attributes: effect, form, strength, sentence, level.

    Raises
    ------
    Fault
        The effect has no form for such a finger.
    """
    forms = effect.list_forms(describe_finger_of_the_paper())
    if isinstance(forms, str):
        raise Fault(f"effect {effect.id!r} cannot be shown: {forms}")
    time = np.linspace(0.0, DURATION_S, FRAMES)
    base = _simulate(build_slots(TRIALS, JOINTS, {}), time)
    for strength in STRENGTHS:
        moved = _simulate(_fill_slots(effect, forms[0], strength), time)
        if np.abs(moved - base).max() > SEEN * np.abs(base).max():
            break
    return xr.Dataset(
        {
            "joint_angle": (("model", "trial", "joint", "frame"), np.stack([base, moved])),
            "load": ("frame", LARGEST_NM * np.interp(time, LOAD_TIME_S, LOAD_SHARE)),
        },
        {
            "model": ["without", "with"],
            "trial": np.arange(1, TRIALS + 1),
            "joint": np.arange(1, JOINTS + 1),
            "time": ("frame", time),
        },
        {
            "effect": effect.id,
            "form": forms[0].name,
            "strength": strength,
            "sentence": effect.sentence,
            "level": effect.level,
        },
    )


def describe_finger_of_the_paper() -> Setting:
    """Describe a campaign that can show every effect."""
    stiffness = np.exp(OWN[:, 0])
    usual = LARGEST_NM / stiffness
    return Setting(
        trials=TRIALS, joints=JOINTS, interval=DURATION_S / (FRAMES - 1), duration=DURATION_S,
        torque=LARGEST_NM, reversals=True, levels=True, rests=True, load_known=True, tension=True,
        stiffness=stiffness, reach=1.1 * usual, number=np.arange(TRIALS, dtype=float),
        memory=np.tile(0.3 * usual, (TRIALS, 1)), largest_torque=np.full(TRIALS, LARGEST_NM),
        rest_time=np.array([np.inf, 20.0, 40.0, 25.0, 35.0, 30.0])[:TRIALS],
        covariates={"temperature_c": np.array([20.0, 21.0, 23.0, 24.0, 22.0, 26.0])[:TRIALS]},
        geometry=True, masses=True, camera=True,
    )  # fmt: skip


def _fill_slots(effect: Effect, form: Form, strength: float) -> SlotArrays:
    per = {parameter.per for parameter in form.parameters}
    pairs = {"pair": [(0, 1), (1, 2)], "neighbours": [(0, 1), (1, 2)]}
    places = next((pairs[kind] for kind in pairs if kind in per), [(j,) for j in range(JOINTS)])
    setting = describe_finger_of_the_paper()
    model = EffectModel(setting, (Piece(effect, form, tuple(places)),))
    mean, sd = model.shared_prior
    shared = np.where(model.amplitudes, mean + strength * sd, mean)
    return model.fill_slots(np.clip(shared, model.low, model.high))


def _simulate(slots: SlotArrays, time: NDArray[np.float64]) -> NDArray[np.float64]:
    geometry = FingerGeometry.uniform([0.025] * JOINTS, [0.005] * JOINTS, 0.008, 0.005)
    own = np.tile(OWN, (TRIALS, 1, 1))
    load = LOAD_TIME_S, LARGEST_NM * LOAD_SHARE
    finger = describe_finger(geometry)
    return simulate_joint_angle_array(own, slots, [], finger, time, *load, by_own=False)[0]
