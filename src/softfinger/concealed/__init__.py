"""The proof: campaigns with concealed physics, generated and scored.

It has a generator of its own. Nothing here imports the forward model, the statistics or the
diagnosis that it puts to the test.
"""

from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.seal import open_seal, seal, seal_file
from softfinger.concealed.strength import calibrate_strength
from softfinger.concealed.suite import CaseSpec, build_paper_case, draw_suite

__all__ = [
    "CaseSpec",
    "build_paper_case",
    "calibrate_strength",
    "draw_suite",
    "generate_campaign",
    "open_seal",
    "seal",
    "seal_file",
]
