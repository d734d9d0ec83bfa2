"""What causes the spread of the motion."""

from softfinger.report.blocks import Paragraph, Section, keep_blocks
from softfinger.report.formatting import format_number, format_percent, join_words
from softfinger.report.material import Material
from softfinger.report.pictures.spread import picture_sobol


def build_causes(material: Material) -> Section:
    """Build the Sobol indices, and the main cause in words."""
    more = (("sensitivity", "shares in numbers, and correlated parameters"),)
    sentences = describe_causes(material)
    blocks = keep_blocks(*(Paragraph(sentence) for sentence in sentences), picture_sobol(material))
    found = blocks or (Paragraph("The sensitivity was not computed.", "note"),)
    return Section("causes", "What causes the spread", found, more)


def describe_causes(material: Material) -> list[str]:
    """State which parameter causes most of the spread.

    The time is that at which the spread is widest.
    """
    found = material.find("causes")
    if found is None or material.is_alone:
        return []
    parts = []
    for joint in found["joint"].values:
        here = found.sel(joint=joint)
        share, when = float(here["share"]), float(here["widest"])
        share_then = f"{format_percent(share)} after {format_number(when)} s"
        parts.append(f"{here['cause'].item()} at joint {joint} ({share_then})")
    return [f"Where the spread between trials is widest, it is mostly that of {join_words(parts)}."]
