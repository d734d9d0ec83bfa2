"""What a fit knew of its campaign, as data.

The data are constant. With them a model file's effects move new trials without another fit.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.forward.simulate import Finger

_JOINT, _TRIAL, _PAIR = ("joint",), ("trial",), ("joint", "other_joint")
SETTING = {
    "interval": (),
    "duration": (),
    "torque": (),
    "reversals": (),
    "levels": (),
    "rests": (),
    "load_known": (),
    "tension": (),
    "stiffness": _JOINT,
    "reach": _JOINT,
    "number": _TRIAL,
    "memory": ("trial", "joint"),
    "largest_torque": _TRIAL,
    "rest_time": _TRIAL,
    "geometry": (),
    "masses": (),
    "step_gap": (),
    "camera": (),
    "specimen": (),
    "first_seen": (),
    "own_time": _JOINT,
}
"""Field of `Setting` → dims; all but the sizes and the covariates."""
FINGER = {
    "arm_ratio": (),
    "moment": _JOINT,
    "inertia": _PAIR,
    "link_length": _JOINT,
    "marker_middle": ("body",),
    "optical_centre": ("axis",),
}
"""Field of `Finger` → dims; `body` counts base and links."""


def tabulate_setting(setting: Setting, finger: Finger, trial: Sequence[str]) -> xr.Dataset:
    """Tabulate a campaign's setting and finger.

    Parameters
    ----------
    trial
        Names of the trials that the setting describes.

    Returns
    -------
    Dataset
        setting_* and finger_*, in the units of `Setting` and `Finger`, and setting_covariate
        (covariate, trial).
    """
    values = {f"setting_{name}": (dims, getattr(setting, name)) for name, dims in SETTING.items()}
    values |= {f"finger_{name}": (dims, getattr(finger, name)) for name, dims in FINGER.items()}
    covariate = np.array([*setting.covariates.values()]).reshape(-1, setting.trials)
    return xr.Dataset(
        {**values, "setting_covariate": (("covariate", "trial"), covariate)},
        {"trial": list(trial), "covariate": np.array([*setting.covariates], str)},
    )


def read_setting(constant: xr.Dataset) -> tuple[Setting, Finger, xr.DataArray]:
    """Read the setting that `tabulate_setting` made.

    Raises
    ------
    Fault
        The posterior was fitted without it.
    """
    missing = [name for name in SETTING if f"setting_{name}" not in constant]
    if missing:
        raise Fault(
            f"the posterior's constant_data has no setting_{missing[0]}: it was fitted by an "
            "older version; fit again"
        )
    fields = {
        name: constant[f"setting_{name}"].transpose(*dims).to_numpy()
        for name, dims in SETTING.items()
    }
    fields = {name: value if value.ndim else value.item() for name, value in fields.items()}
    names = [str(name) for name in constant["covariate"].values]
    covariate = constant["setting_covariate"].transpose("covariate", "trial").to_numpy()
    setting = Setting(
        trials=constant.sizes["trial"],
        joints=constant.sizes["joint"],
        covariates=dict(zip(names, covariate, strict=True)),
        **fields,
    )
    finger = [
        constant[f"finger_{name}"].transpose(*dims).to_numpy() for name, dims in FINGER.items()
    ]
    return setting, Finger(float(finger[0]), *finger[1:]), constant["trial"]
