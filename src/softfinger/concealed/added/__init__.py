"""Effects added to real recordings, and answers judged.

A real body has no known truth. An effect of known size that is added to its recordings has one.
"""

from softfinger.concealed.added.apply import Addition, draw_additions, write_added
from softfinger.concealed.added.body import Body, read_bodies
from softfinger.concealed.added.expected import accepts, claims, is_confident

__all__ = [
    "Addition",
    "Body",
    "accepts",
    "claims",
    "draw_additions",
    "is_confident",
    "read_bodies",
    "write_added",
]
