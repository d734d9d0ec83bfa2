"""A damper that resists less when fast.

The rate is r (1 + s |r|): r is that of the linear element, and s is in s/rad.
"""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="thinning_damper",
    sentence="stiffness against fast motion that falls with the rate",
    level="within_trial",
    joints="any",
    typical=0.3,
    largest=3.0,
    move=set_amount("thinning"),
)
