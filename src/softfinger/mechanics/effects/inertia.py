"""Mass that the step solution ignores."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.masses:
        return "link masses and lengths are not declared"
    scale = positive("inertia_scale", 1.0, floor=0.05)

    def slots(values: Values) -> dict:
        return {"inertia_scale": values["inertia_scale"]}

    return [Form("declared_masses", (scale,), slots)]


EFFECT = Effect("inertia", "the links have mass", "within_trial", _build_forms)
