"""Friction along the wire: distal joints get less, and loading differs from unloading.

Capstan over the bend (tension · exp(−μ · bend)) up to the middle of the joint that is pulled, or
over all that the wire wraps, whole bends and guides; a constant loss for each joint passed, a
Coulomb force, or a free law of the bend. The direction turns over a small motion of the wire (Dahl)
or with the load.

Dahl (1968), Aerospace Corp. TOR-0158(3107-18)-1.
"""

import numpy as np

from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    positive,
)
from softfinger.mechanics.effects.law import Law, free_form


def _build_form(law: str, driver: str, setting: Setting) -> Form:
    force = law == "force"
    name = "friction_torque_nm" if force else "friction_coefficient"
    amplitude = positive(
        name,
        0.1 * setting.torque if force else 0.2,
        floor=1e-4 * (setting.torque if force else 1.0),
    )
    middle = np.log(0.02 if driver == "motion" else 0.02 * setting.torque)
    width = Parameter("turning_width", middle, 1.0, log=True, low=middle - 3, high=middle + 3)
    guide = Parameter("guide_rad", np.log(0.3), 1.0, log=True, low=np.log(0.01), high=np.log(3.0))

    def slots(values: Values) -> dict:
        motion = float(driver == "motion")
        turn = {"friction_width": values["turning_width"], "friction_driver": motion}
        if law != "wrap":
            return {f"friction_{law}": values[name]} | turn
        bend, guides = values[name], values[name] * values["guide_rad"]
        whole = {"friction_bend": bend, "friction_constant": guides, "friction_own": 1.0}
        return whole | turn

    parameters = (amplitude, guide, width) if law == "wrap" else (amplitude, width)
    return Form(f"{law}_by_{driver}", parameters, slots)


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.tension:
        return "the load is not a wire tension"
    if not setting.reversals and setting.joints < 2:
        return "friction shows where the load turns back or along several joints"
    laws = ("bend", "wrap", "constant", "force")
    drivers = ("motion", "load") if setting.reversals else ("load",)
    forms = [_build_form(law, driver, setting) for law in laws for driver in drivers]
    reach = float(setting.reach.sum())
    bend = Law("friction_law", "bend_rad", reach, 0.2, terms=4, kind="sum")
    return [*forms, free_form(bend, {"friction_reach": reach}, forms[0])]


EFFECT = Effect(
    "wire_friction",
    "the wire loses tension to friction on its way",
    "within_trial",
    _build_forms,
    "wire",
)
