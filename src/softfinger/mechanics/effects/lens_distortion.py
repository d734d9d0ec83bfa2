"""Angles bent by the optics: radial distortion of the picture, or an odd cubic in the angle."""

from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, signed

AXES = ("along", "across")
CENTRE_SD_M = 0.015  # how far from the middle of the straight finger a camera may look


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.camera:
        return "nothing was filmed, and no camera is declared"
    cubic = signed("angle_cubic_per_rad2", 0.1, per="joint", floor=1e-4)
    radial = signed("lens_radial_per_m2", 10.0, floor=5e-3)

    def bent(values: Values) -> dict:
        return {"angle_cubic": values["angle_cubic_per_rad2"]}

    def lens(values: Values) -> dict:
        return {"lens_radial": values["lens_radial_per_m2"]}

    def shifted_lens(values: Values) -> dict:
        place = {"lens_along": values["lens_along_m"], "lens_across": values["lens_across_m"]}
        return lens(values) | place

    forms = [Form("cubic", (cubic,), bent)]
    if setting.masses:
        centre = [Parameter(f"lens_{k}_m", 0.0, CENTRE_SD_M, starts=(0.0,)) for k in AXES]
        forms.insert(0, Form("radial", (radial,), lens))
        forms.insert(1, Form("radial_off_centre", (radial, *centre), shifted_lens))
    return forms


EFFECT = Effect(
    "lens_distortion", "the optics bend the angles", "measurement", _build_forms, "lens"
)
