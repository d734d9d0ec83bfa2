"""What programs may import and rely on.

These names stay as they are within a major version; all else may move. An effect of your own needs
the first nine; recordings and results the others.
"""

from softfinger.api.results import Results, open_results
from softfinger.api.workflow import run
from softfinger.campaign import read_campaign
from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Parameter,
    Setting,
    positive,
    signed,
    time_constant,
)
from softfinger.mechanics.effects.law import Law, free_form

__all__ = [
    "Effect",
    "Fault",
    "Form",
    "Law",
    "Parameter",
    "Results",
    "Setting",
    "free_form",
    "list_effects",
    "open_results",
    "positive",
    "read_campaign",
    "run",
    "signed",
    "time_constant",
]
