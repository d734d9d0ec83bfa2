"""True motion of every trial's finger, with inertia."""

import numpy as np
import xarray as xr

from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.effects.model_file import ModelFile
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.virtual_rig.config import read_rig_config
from softfinger.virtual_rig.effects import move_with_effects
from softfinger.virtual_rig.population import draw_finger_parameters


def draw_motion(config: dict, seed: int, model: ModelFile | None = None) -> xr.Dataset:
    """Draw every trial's parameters and simulate its motion.

    The motion follows the full equations of motion.

    Parameters
    ----------
    config
        The virtual rig's block of the configuration; what only pictures depend on may be absent.
    seed
        Root of the trials' streams; trial k is the same however many trials follow.
    model
        Further physics that the finger has.

    Returns
    -------
    Dataset
        The truth: k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad] (trial, joint); joint_angle
        (trial, joint, frame) [rad], with time (frame) [s]; load_time [s], load_tension [N] (knot);
        population_mean, population_sd (joint, parameter), of the logarithm except for q_ini.
    """
    rig = read_rig_config(config)
    drawn = draw_finger_parameters(rig.n_trials, seed)
    time = np.arange(rig.n_frames) / rig.fps
    load_time, load_tension = np.array(rig.load_time_s), np.array(rig.load_tension_n)
    geometry = FingerGeometry.uniform(
        rig.link_length_m, rig.link_mass_kg, rig.joint_length_m, rig.wire_offset_m
    )
    if model is None:
        angle = simulate_full_dynamics(
            drawn[["k_v", "c_v", "c_p", "q_ini"]],
            geometry,
            time,
            load_time,
            load_tension,
            rig.wire_geometry,
        ).joint_angle
    else:
        angle = move_with_effects(model, rig, drawn, time, seed)
    return drawn.assign(
        joint_angle=angle,
        load_time=("knot", load_time),
        load_tension=("knot", load_tension),
    )
