"""Play: a joint whose spring asks for no torque within a gap about its rest."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive

WIDTH_RAD = 0.005  # over which the torque sets in


def _build_forms(setting: Setting) -> list[Form]:
    play = positive("play_rad", 0.05, per="joint", floor=2e-4)

    def slots(values: Values) -> dict:
        return {"play": values["play_rad"], "play_width": WIDTH_RAD}

    return [Form("gap", (play,), slots)]


EFFECT = Effect(
    "joint_play", "the joint has play before its spring takes up the torque", "within_trial",
    _build_forms,
)  # fmt: skip
