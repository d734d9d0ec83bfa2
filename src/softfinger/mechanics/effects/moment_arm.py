"""The wire's own geometry: a moment arm r sin(q/2 + a) that grows with the angle."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.tension:
        return "the load is not a wire tension"
    if not setting.geometry:
        return "joint length and wire offset are not declared"
    arm = positive("arm_scale", 1.0, floor=5e-3)

    def slots(values: Values) -> dict:
        return {"arm_scale": values["arm_scale"]}

    return [Form("paper_geometry", (arm,), slots)]


EFFECT = Effect(
    "moment_arm", "the wire's moment arm changes with the angle", "within_trial", _build_forms
)
