"""Creep rate more than proportional to torque: Eyring's sinh or a power.

Eyring (1936), J. Chem. Phys. 4, 283.
"""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.levels < 2 and not setting.reversals:
        return "a single constant load: any law of flow vanishes in c_p"
    bend = positive("inverse_scale_torque_per_nm", 2 / setting.torque, floor=0.1 / setting.torque,
                    starts=(0.5 / setting.torque, 2 / setting.torque))  # fmt: skip
    power = positive("extra_power", 1.0, floor=0.02, starts=(0.2, 1.0))

    def sinh(values: Values) -> dict:
        return {"flow_sinh": values["inverse_scale_torque_per_nm"]}

    def power_law(values: Values) -> dict:
        return {"flow_power": values["extra_power"], "flow_reference": setting.torque}

    return [Form("sinh", (bend,), sinh), Form("power", (power,), power_law)]


EFFECT = Effect(
    "stress_nonlinear_flow",
    "the joint creeps more than in proportion to the torque",
    "within_trial",
    _build_forms,
)
