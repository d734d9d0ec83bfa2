"""The virtual finger with a model file's effects."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics import PARAMETERS
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mechanics.effects.model_file import ModelFile, build_model, read_strength
from softfinger.mechanics.effects.spread import vary_effects
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays, build_slots
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.virtual_rig.campaign_folder import draw_temperature
from softfinger.virtual_rig.config import RigConfig
from softfinger.virtual_rig.streams import Purpose, build_generator


def move_with_effects(
    content: ModelFile, rig: RigConfig, drawn: xr.Dataset, time: NDArray, seed: int
) -> xr.DataArray:
    """Simulate drawn trials with a model file's effects.

    The links have inertia.

    Parameters
    ----------
    drawn
        k_v, c_v, c_p, q_ini (trial, joint).
    time
        (frame,) [s]

    Returns
    -------
    DataArray
        joint_angle (trial, joint, frame) [rad].
    """
    own = np.stack([drawn[name].transpose("trial", "joint").to_numpy() for name in PARAMETERS], -1)
    own[..., :3] = np.log(own[..., :3])
    load = np.array(rig.load_time_s), np.array(rig.load_tension_n) * rig.wire_offset_m
    model = build_model(content, describe_setting(rig, own, load, seed))
    arm = {"arm_scale": 1.0} if rig.wire_geometry == "paper" else {}
    usual = build_slots(*own.shape[:2], {"inertia_scale": 1.0, **arm})
    absent = build_slots(*own.shape[:2], {})
    chosen = _fill_trials(model, content, seed)
    slots = SlotArrays(
        *(np.where(a == none, b, a) for a, b, none in zip(chosen, usual, absent, strict=True))
    )
    geometry = FingerGeometry.uniform(
        rig.link_length_m, rig.link_mass_kg, rig.joint_length_m, rig.wire_offset_m
    )
    angle, _ = simulate_joint_angle_array(
        own, slots, [], describe_finger(geometry), time, *load, by_own=False
    )
    coords = {"trial": drawn["trial"], "joint": drawn["joint"], "time": ("frame", time)}
    return xr.DataArray(angle, coords, ("trial", "joint", "frame"), name="joint_angle")


def _fill_trials(model: EffectModel, content: ModelFile, seed: int) -> SlotArrays:
    """Slots of all trials, with spreads of each."""
    middle = read_strength(model)
    same = model.fill_slots(middle)
    if not content.spreads:
        return same
    filled = SlotArrays(*(whole.copy() for whole in same))
    for i in range(model.setting.trials):
        rng = build_generator(seed, i, Purpose.EFFECTS)
        own = model.fill_slots(vary_effects(model, middle[None], content.spreads, rng)[0])
        for whole, part in zip(filled, own, strict=True):
            whole[i] = part[i]
    return filled


def describe_setting(
    rig: RigConfig, own: NDArray, load: tuple[NDArray, NDArray], seed: int
) -> Setting:
    """Describe the campaign that a rig will record.

    It is described before the rig moves.

    Parameters
    ----------
    own
        (trial, joint, 4): log k_v, log c_v, log c_p, q_ini.
    load
        Knots [s] and torque [N m].
    """
    trials, joints, _ = own.shape
    size = np.abs(load[1])
    torque = float(size.max())
    reached = np.maximum.accumulate(size)
    stiffness = np.exp(np.median(own[..., 0], axis=0))
    rate = np.exp(own[..., 0] - own[..., 1])
    last = compute_elastic_basis_array(rate.ravel(), np.array([rig.duration_s]), *load)[0]
    memory = np.zeros((trials, joints))
    memory[1:] = (last[:, 0].reshape(trials, joints) / np.exp(own[..., 0]))[:-1]
    rooms = (build_generator(seed, k, Purpose.ROOM) for k in range(trials))
    rest = np.full(trials, rig.trial_interval_s - rig.duration_s)
    rest[0] = np.inf
    return Setting(
        trials=trials,
        joints=joints,
        interval=1.0 / rig.fps,
        duration=rig.duration_s,
        torque=torque,
        reversals=bool(np.any(size < 0.95 * reached)),
        levels=True,
        rests=bool(np.any((size < 0.1 * reached) & (reached > 0.1 * torque))),
        load_known=True,
        tension=True,
        stiffness=stiffness,
        reach=torque / stiffness + np.median(own[..., 3], axis=0),
        number=np.arange(trials, dtype=float),
        memory=memory,
        largest_torque=np.full(trials, torque),
        rest_time=np.maximum(rest, 0.0),
        covariates={"temperature_c": np.array([draw_temperature(room) for room in rooms])},
        geometry=True,
        masses=True,
        camera=True,
        own_time=np.median(1.0 / rate, axis=0),
    )
