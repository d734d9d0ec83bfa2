"""The parameters and their spread, in one table."""

from softfinger.figures.style import label_parameter_unit
from softfinger.report.blocks import Paragraph, Section, Table, keep_blocks, number, text
from softfinger.report.formatting import capital, format_interval, format_percent
from softfinger.report.material import Material
from softfinger.report.sections.parameters import each_parameter

ALONE = Paragraph(
    "One trial cannot show how much trials differ: every spread in this report, and every share "
    "of it, is what was assumed before.",
    "warning",
)


def build_spread(material: Material) -> Section:
    """Build the table of the parameters and their spread."""
    more = (("parameters", "other estimates"), ("model", "the model and its priors"))
    title = "Parameters and their spread"
    summary = material.find("population")
    if summary is None:
        return Section("spread", title, (Paragraph("The fit was not run.", "warning"),), more)
    rows = []
    for parameter, joint, here in each_parameter(summary):
        sigma = here["quantile_value"].sel(statistic="sigma").values
        centre = here["centre_quantile"].values
        rows.append(
            (
                text(parameter),
                number(str(joint), joint),
                text(label_parameter_unit(parameter, material.load_unit, material.motion_unit)),
                number(format_interval(centre[0], centre[-1]), float(here["centre"])),
                number(format_interval(sigma[0], sigma[-1]), float(sigma[2])),
            )
        )
    caption = (
        f"{format_percent(material.ci_prob)} intervals of the median over trials and of the sd "
        f"between trials: of the logarithm, of q_ini in {material.motion_unit}. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("parameter", "joint", "unit", "centre", "spread")
    table = Table("in_short", "Centre and spread", caption, columns, tuple(rows))
    return Section("spread", title, keep_blocks(table, ALONE if material.is_alone else None), more)
