"""What to record next."""

from softfinger.report.blocks import Listing, Section
from softfinger.report.material import Material
from softfinger.report.sections.outlook import count_unsure, list_data_limits
from softfinger.report.verdict import describe_next


def build_next(material: Material) -> Section:
    """Build the proposed experiment, and what more trials would show."""
    proposed = describe_next(material.artifacts.get("verdict") or {})
    items = [*proposed, *count_unsure(material), *list_data_limits(material)[:1]]
    outlook = (("outlook", "what would change the conclusion"),) if material.is_fitted else ()
    more = (*outlook, ("origin", "how to rerun this"))
    return Section("next", "What to record next", (Listing(tuple(items)),), more)
