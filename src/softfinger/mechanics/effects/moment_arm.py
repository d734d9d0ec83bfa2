"""The wire's geometry: a moment arm that grows with the angle, as r sin(q/2 + a) or otherwise."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.tension:
        return "the load is not a wire tension"
    reach = float(setting.reach.max())
    law = Law("arm_law", "joint_angle_rad", reach, 0.5)
    free = free_form(law, {"arm_reach": reach})
    if not setting.geometry:
        return [free]
    arm = positive("arm_scale", 1.0, floor=5e-3)

    def slots(values: Values) -> dict:
        return {"arm_scale": values["arm_scale"]}

    return [Form("paper_geometry", (arm,), slots), free]


EFFECT = Effect(
    "moment_arm",
    "the wire's moment arm changes with the angle",
    "within_trial",
    _build_forms,
    "wire",
)
