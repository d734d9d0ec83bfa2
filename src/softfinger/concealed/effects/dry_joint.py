"""A joint with dry friction on its support.

At most s [N m] acts against the joint's motion. It is turned round over 5 mrad.
"""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="dry_joint",
    sentence="dry friction in a joint, against its own motion",
    level="within_trial",
    joints="any",
    typical=0.002,
    largest=0.01,
    move=set_amount("dry"),
)
