"""Every effect of the proof by name: its own law, or a foreign one as ``id/law``."""

from __future__ import annotations

from softfinger.concealed.effects import OWN
from softfinger.concealed.effects.effect import Effect
from softfinger.concealed.foreign import FOREIGN

EFFECTS: dict[str, Effect] = OWN | FOREIGN
