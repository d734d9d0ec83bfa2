"""New trials of a campaign's finger, moved with the effects of a model file."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics.effects.model_file import ModelFile, build_model
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.problem import TOLERANCE, pose_problem

Move = Callable[[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray], NDArray[np.float64]]


def build_mover(angles: xr.Dataset, content: ModelFile, effect: xr.DataArray) -> Move:
    """Build the function that moves new trials of a campaign.

    Parameters
    ----------
    angles
        The `angles` artifact: what differs between trials is that of the trial that a new one is
        like.
    content
        The model file.
    effect
        (draw, effect_parameter), as the fit of that model names and orders them.

    Returns
    -------
    (own (m, joint, 4) logs but for q_ini; draw (m,) of the effects; like (m,) place of a recorded
    trial; time (n,) [s]; load_time, load_torque (knot,)) → angle (m, joint, n) [rad], NaN where
    the model could not be integrated.
    """
    problem, _ = pose_problem(angles)
    model = build_model(content, problem.setting)
    physical = effect.transpose("draw", "effect_parameter").to_numpy()
    internal = physical.copy()
    for k, entry in enumerate(model.entries):
        if entry.parameter.log:
            internal[:, k] = np.log(physical[:, k])
    known = {name: k for k, name in enumerate(problem.trials.name)}
    place = np.array([known.get(str(name), 0) for name in angles["trial"].values])

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
            own[order], slots, [], problem.finger, time, *load, by_own=False, tolerance=TOLERANCE
        )
        moved = np.empty_like(angle)
        moved[order] = angle
        return moved

    return move
