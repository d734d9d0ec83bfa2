"""The verdict in a sentence, with its evidence."""

from softfinger.report.blocks import Listing, Paragraph, Section, keep_blocks
from softfinger.report.formatting import shorten_list
from softfinger.report.material import Material
from softfinger.report.overview.measurement import list_warnings
from softfinger.report.pictures.repair import picture_evidence
from softfinger.report.verdict import NOT_RUN, state_explained, state_verdict

MOST_WARNINGS, MOST_EFFECTS = 1, 2
SUFFER = "what the recordings suffer from"


def build_verdict(material: Material) -> Section:
    """Build the verdict, and warn before it of what looks wrong."""
    warnings = shorten_list(list_warnings(material), MOST_WARNINGS, SUFFER)
    warning = Paragraph(f"Warning: {' '.join(warnings)}", "warning") if warnings else None
    title = "What was found"
    if "verdict" not in material:
        return Section("verdict", title, keep_blocks(warning, Paragraph(NOT_RUN, "note")))
    verdict = material.artifacts["verdict"]
    words = [str(effect["statement"]) for effect in verdict["effects"]]
    words = [*shorten_list(words, MOST_EFFECTS, "left-out physics"), *state_explained(verdict)]
    more = (
        ("mismatch", "left-out physics"),
        ("remains", "what remains"),
        ("catalogue", "every effect"),
    )
    blocks = keep_blocks(
        warning,
        Paragraph(state_verdict(material), "lead"),
        Listing(tuple(words)) if words else None,
        picture_evidence(material),
    )
    return Section("verdict", title, blocks, more)
