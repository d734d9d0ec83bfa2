"""New trials of a finger, moved by the paper's joints or with the effects of a model file."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.problem import TOLERANCE
from softfinger.inference.setting_table import read_setting
from softfinger.mechanics.effects.model_file import ModelFile, build_model
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array

Move = Callable[[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray], NDArray[np.float64]]
"""(own (m, joint, 4), draw (m,), like (m,), time (n,), load_time, load_torque) → (m, joint, n)."""


def move_paper_joint(
    own: NDArray[np.float64],
    draw: NDArray[np.int_],
    like: NDArray[np.int_],
    time: NDArray[np.float64],
    load_time: NDArray[np.float64],
    load_torque: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Move fingers of the paper's joints, each by its own parameters: a `Move`.

    Without the gradient of `compute_joint_angle_array`, which would need four times the memory.

    >>> own = np.log([[[0.1, 0.01, 20.0, np.exp(0.03)]]])
    >>> move_paper_joint(own, 0, 0, np.array([10.0]), np.array([0.0]), np.array([0.04]))
    array([[[0.45]]])
    """
    k_v, c_v, c_p = np.exp(np.moveaxis(own[..., :3], -1, 0))[..., None]
    rate = (k_v / c_v).ravel()
    lagged = compute_elastic_basis_array(rate, time, load_time, load_torque)[0]
    flow = integrate_load_array(time, load_time, load_torque) / c_p
    return lagged.reshape(*own.shape[:2], -1) / k_v + flow + own[..., 3, None]


def build_mover(
    constant: xr.Dataset, content: ModelFile, effect: xr.DataArray, trial: xr.DataArray
) -> Move:
    """Build the function that moves new trials of a campaign.

    Parameters
    ----------
    constant
        The fit's constant data, of `tabulate_setting`: what differs between trials is that of the
        trial that a new one is like.
    content
        The model file.
    effect
        (draw, effect_parameter), as the fit of that model names and orders them.
    trial
        Names of the recorded trials, in the order in which `like` counts them.

    Returns
    -------
    (own (m, joint, 4) logs but for q_ini; draw (m,) of the effects; like (m,) place of a recorded
    trial; time (n,) [s]; load_time, load_torque (knot,)) → angle (m, joint, n) [rad], NaN where
    the model could not be integrated.
    """
    setting, finger, fitted = read_setting(constant)
    model = build_model(content, setting)
    physical = effect.transpose("draw", "effect_parameter").to_numpy()
    internal = physical.copy()
    for k, entry in enumerate(model.entries):
        if entry.parameter.log:
            internal[:, k] = np.log(physical[:, k])
    known = {name: k for k, name in enumerate(fitted.values)}
    place = np.array([known.get(name, 0) for name in trial.values])

    def move(
        own: NDArray, draw: NDArray, like: NDArray, time: NDArray, *load: NDArray
    ) -> NDArray[np.float64]:
        order = np.argsort(draw, kind="stable")
        parts = []
        for k in np.unique(draw):
            slots = model.fill_slots(internal[k])
            chosen = place[like[draw == k]]
            parts.append(SlotArrays(*(slot[chosen] for slot in slots)))
        slots = SlotArrays(*(np.concatenate(p) for p in zip(*parts, strict=True)))
        angle, _ = simulate_joint_angle_array(
            own[order], slots, [], finger, time, *load, by_own=False, tolerance=TOLERANCE
        )
        moved = np.empty_like(angle)
        moved[order] = angle
        return moved

    return move
