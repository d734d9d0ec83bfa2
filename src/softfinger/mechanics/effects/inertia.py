"""Mass that the step solution ignores: of the declared links, or of even links of unknown mass.

Where nothing is declared the unit of inertia is that with which a joint of usual stiffness would
swing once in ten frames.
"""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form]:
    declared = positive("inertia_scale", 5.0, floor=2e-3)  # tubes and wires weigh too
    unknown = positive("inertia_in_units_of_ten_frames", 3.0, floor=5e-4)

    def slots(values: Values) -> dict:
        return {"inertia_scale": next(iter(values.values()))}

    if setting.masses:
        return [Form("declared_masses", (declared,), slots)]
    return [Form("even_links", (unknown,), slots)]


EFFECT = Effect("inertia", "the links have mass", "within_trial", _build_forms)
