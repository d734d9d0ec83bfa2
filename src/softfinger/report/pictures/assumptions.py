"""The paper's assumptions, checked on simulated fingers."""

from softfinger.figures.assumptions import draw_assumptions
from softfinger.report.blocks import Picture
from softfinger.report.formatting import capital
from softfinger.report.material import Material


def picture_assumptions(material: Material) -> Picture | None:
    """Draw the step solution beside the full dynamics."""
    if "assumptions" not in material:
        return None
    found = material.artifacts["assumptions"]
    n, tension = found.sizes["trial"], found.attrs["tension_n"]
    return Picture(
        "assumptions",
        "What the step solution leaves out",
        draw_assumptions(found.assign_attrs(source="synthetic"), material.find("assumptions")),
        "Gaps over time at each joint; growth of the torque; changes of the fitted parameters.",
        "Above: by how much inertia, and the moment arm that grows as a joint bends, move the "
        f"angle of {n} simulated fingers of the paper's table under {tension:g} N, largest and rms "
        "over the fingers; the grey line is 1 mrad. Below: how the torque grows, and by how much "
        "the step solution's parameters then miss the true ones (median and 90 % of the fingers). "
        f"{capital(material.cite('assumptions'))}.",
    )
