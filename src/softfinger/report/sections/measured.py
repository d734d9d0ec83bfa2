"""Each component of the measurement, with its figure."""

from softfinger.report.blocks import Block, Paragraph, Section, Table, keep_blocks, number, text
from softfinger.report.formatting import count_things, format_number
from softfinger.report.material import Material
from softfinger.report.pictures.measurement import picture_measurement
from softfinger.units import label_thousandth

TITLE = "The measurement in numbers"


def build_measured(material: Material) -> Section:
    """Build the page of findings about the measurement."""
    if "measurement" not in material:
        absent = Paragraph("The measurement is judged by the diagnosis, which was not run.", "note")
        return Section("measured", TITLE, (absent,))
    found = (material.artifacts.get("verdict") or {}).get("measurement") or []
    blocks: list[Block | None] = [
        Paragraph(
            f"{count_things(len(found), 'finding')}. Each is a part of the model of the noise, and "
            "none of them changes the verdict on the physics."
        ),
        build_findings(found) if found else None,
        build_noise(material),
        None if found else picture_measurement(material),  # else the first layer has it
    ]
    return Section("measured", TITLE, keep_blocks(*blocks))


def build_findings(found: list[dict]) -> Table:
    """Table of findings: size, evidence, place, sentence."""
    rows = []
    for one in found:
        ((key, size),) = one["size"].items()
        rows.append(
            (
                text(str(one["id"]).replace("_", " ")),
                number(format_number(float(size)), float(size)),
                text(key.replace("_", " ")),
                number(format_number(float(one["evidence"])), float(one["evidence"])),
                text(str(len(one["trials"]) or "all")),
                text(str(one["statement"])),
            )
        )
    columns = ("finding", "size", "of", "evidence [nats]", "trials", "in words")
    caption = "Evidence: log of how much more probable it makes the recordings. Rule diagnose."
    return Table("findings", "Findings about the measurement", caption, columns, tuple(rows))


def build_noise(material: Material) -> Table:
    """Tabulate the noise of every joint."""
    known = material.get("measurement")
    unit = label_thousandth(material.motion_unit)
    rows = []
    for joint in known["joint"].values:
        here = known.sel(joint=joint)
        sd, kept = 1e3 * float(here["noise_sd"]), float(here["noise_autocorrelation"])
        windows = int(here["window_count"])
        rows.append(
            (
                number(str(joint), joint),
                number(format_number(sd), sd),
                number(format_number(kept), kept),
                number(str(windows), windows),
            )
        )
    columns = ("joint", f"sd [{unit}]", "kept from frame to frame", "quiet windows")
    caption = (
        "Standard deviation at rest, autocorrelation over a frame interval, and the number of "
        "windows that show them. Rule diagnose, artifact measurement."
    )
    return Table("noise", "The noise of every joint", caption, columns, tuple(rows))
