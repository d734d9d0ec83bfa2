"""The figure of what no listed effect explains."""

from softfinger.figures.free_form import draw_free_form
from softfinger.report.blocks import Picture
from softfinger.report.material import Material
from softfinger.report.pictures.repair import say_trials


def picture_free_form(material: Material) -> Picture | None:
    """Draw the shape of what no effect explains.

    None where there is none.
    """
    if "free_form" not in material or not material.get("free_form")["quantity"].size:
        return None
    free_form = material.get("free_form")
    followed = (
        " The angle follows it with the retardation time of the Voigt element."
        if free_form.attrs["argument"] == "rate_rad_per_s"
        else ""
    )
    return Picture(
        "free_form",
        "The shape of what no listed effect explains",
        draw_free_form(free_form, material.load_unit),
        "Free-form curve of what is missing, for each joint, against what it depends on.",
        "Cubic spline that is added to the model, the same in every trial: its posterior mean, "
        f"and shaded twice its standard deviation.{followed} n = {say_trials(material)}. Rule "
        "diagnose, artifact free_form.",
    )
