"""A dashpot that yields at a soft corner."""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="yield_threshold",
    sentence="a dashpot that flows only above a torque",
    level="within_trial",
    joints="any",
    typical=0.01,
    largest=0.03,
    move=set_amount("yield_torque"),
    tell=lambda dose, trials: {"threshold_nm": dose.strength},
)
