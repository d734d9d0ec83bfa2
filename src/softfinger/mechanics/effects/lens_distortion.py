"""Angles bent by the optics: radial distortion of the picture, or an odd cubic in the angle."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, signed


def _build_forms(setting: Setting) -> list[Form]:
    cubic = signed("angle_cubic_per_rad2", 0.1, per="joint", floor=2e-3)
    radial = signed("lens_radial_per_m2", 10.0, floor=0.1)

    def bent(values: Values) -> dict:
        return {"angle_cubic": values["angle_cubic_per_rad2"]}

    def lens(values: Values) -> dict:
        return {"lens_radial": values["lens_radial_per_m2"]}

    forms = [Form("cubic", (cubic,), bent)]
    if setting.masses:
        forms.insert(0, Form("radial", (radial,), lens))
    return forms


EFFECT = Effect("lens_distortion", "the optics bend the angles", "measurement", _build_forms)
