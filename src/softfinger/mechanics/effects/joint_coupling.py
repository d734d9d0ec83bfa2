"""One joint's deflection that feeds its neighbour's: by torque, a membrane or kinematics."""

import numpy as np

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, signed
from softfinger.mechanics.effects.effect import time_constant as between


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.joints < 2:
        return "there is only one joint"
    stiffness = float(np.median(setting.stiffness))
    share = signed("coupling", 0.1, per="pair", floor=1e-4)
    mutual = signed("coupling", 0.1, per="neighbours", floor=1e-4)
    reach = setting.reach.max()
    # faster would be a torque that is there at once and then constant: no coupling any more
    saturation = between("saturation_per_rad", 0.1 / reach, 3.0 / reach, starts=1)

    def torque(values: Values) -> dict:
        return {"coupling_stiffness": values["coupling"] * stiffness}

    def own_share(values: Values) -> dict:
        return {"coupling_share": values["coupling"]}

    def kinematic(values: Values) -> dict:
        return {"coupling_kinematic": values["coupling"]}

    def mutual_torque(values: Values) -> dict:
        both = values["coupling"] + values["coupling"].T
        return {"coupling_stiffness": both * stiffness}

    def membrane(values: Values) -> dict:
        return {"membrane_stiffness": (values["coupling"] + values["coupling"].T) * stiffness}

    def membrane_share(values: Values) -> dict:
        return {"membrane_share": values["coupling"] + values["coupling"].T}

    def slackening(values: Values) -> dict:
        return {**mutual_torque(values), "coupling_saturation": values["saturation_per_rad"]}

    return [
        Form("mutual_torque", (mutual,), mutual_torque),
        Form("membrane", (mutual,), membrane),
        Form("membrane_share", (mutual,), membrane_share),
        Form("slackening_torque", (mutual, saturation), slackening),
        Form("torque", (share,), torque),
        Form("share_of_stiffness", (share,), own_share),
        Form("kinematic", (share,), kinematic),
    ]


EFFECT = Effect(
    "joint_coupling",
    "one joint's deflection feeds its neighbour's",
    "within_trial",
    _build_forms,
    "second joint",
)
