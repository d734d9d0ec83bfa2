"""Softening by the largest strain before (Mullins)."""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="mullins_softening",
    sentence="stiffness lost within a trial up to the largest strain so far",
    level="within_trial",
    joints="any",
    typical=0.1,
    largest=0.5,
    move=set_amount("mullins"),
)
