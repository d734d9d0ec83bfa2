"""What the recordings themselves suffer from."""

from softfinger.report.blocks import Listing, Section, keep_blocks
from softfinger.report.formatting import count_things, shorten_list
from softfinger.report.material import Material
from softfinger.report.pictures.measurement import picture_measurement
from softfinger.report.sections.data import describe_flags

MOST_FINDINGS = 3


def build_measurement(material: Material) -> Section:
    """Build warnings, findings, flags and trials set aside."""
    verdict = material.artifacts.get("verdict") or {}
    found = [str(part["statement"]) for part in verdict.get("measurement") or ()]
    none = [] if found or not verdict else ["The diagnosis found nothing in the measurement."]
    items = [*list_warnings(material), *found]
    if material.is_fitted:  # the page of a diagnosis has room for all
        items = shorten_list(items, MOST_FINDINGS, "the numbers")
    items += [*none, describe_flags(material)]
    aside = material.angles["set_aside_trial"].size
    if aside:
        items.append(f"{count_things(aside, 'trial')} set aside, each with its reason.")
    more = (("measured", "in numbers"), ("data", "every trial, and those set aside"))
    title = "What the recordings suffer from"
    picture = picture_measurement(material) if found else None
    return Section("measurement", title, keep_blocks(Listing(tuple(items)), picture), more)


def list_warnings(material: Material) -> list[str]:
    """List what looks wrong in the recordings, each once."""
    verdict = material.artifacts.get("verdict") or {}
    said = [str(warning["statement"]) for warning in verdict.get("warnings") or ()]
    if "doubts" in material:
        said += material.artifacts["doubts"]["statement"].values.astype(str).tolist()
    return list(dict.fromkeys(f"{words.rstrip('.')}." for words in said))
