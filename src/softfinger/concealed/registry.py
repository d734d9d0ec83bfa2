"""Every effect of the proof by name.

The name is the id for the effect's own law, ``id/law`` for a foreign one.
"""

from softfinger.concealed.effects import OWN
from softfinger.concealed.effects.effect import Effect
from softfinger.concealed.foreign import FOREIGN

EFFECTS: dict[str, Effect] = OWN | FOREIGN
