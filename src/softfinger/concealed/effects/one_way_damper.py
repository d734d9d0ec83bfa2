"""A damper that gives way more easily bending.

The Voigt element's rate is 1 + s times as large while it bends. No law of the rate's size
distinguishes the two directions.
"""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="one_way_damper",
    sentence="a damper that resists a return more than a bend",
    level="within_trial",
    joints="any",
    typical=0.3,
    largest=2.0,
    move=set_amount("one_way"),
)
