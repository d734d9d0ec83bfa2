"""A campaign folder to fill in, from declared keys."""

import json
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from softfinger.campaign.camera import Camera
from softfinger.campaign.description import FILE_NAME, DeclaredFinger, Description
from softfinger.campaign.specimen import Motion, Quantity
from softfinger.campaign.trials import TABLE_NAME
from softfinger.faults import Fault

HEAD = """\
# One finger or specimen, on one rig: a campaign. Fill in what is empty. A line after # is
# optional: to use it, remove its #. `softfinger check` lists what is still empty.
"""


def write_template(folder: Path, *, specimen: bool = False, video: bool = False) -> list[Path]:
    """Write a campaign folder whose values are still empty.

    Parameters
    ----------
    folder
        New, or empty.
    specimen
        It is of a specimen with one degree of freedom, and not of a finger.
    video
        The recordings are videos, and so a camera is declared.

    Returns
    -------
    The description and the table of trials.

    Raises
    ------
    Fault
        The folder is there and not empty.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise Fault(f"{folder}: exists already; choose a folder that is new or empty")
    level = "video" if video else "angles"
    for name in (level, "load"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    description, table = folder / FILE_NAME, folder / TABLE_NAME
    description.write_text(format_template(specimen=specimen, video=video), encoding="utf-8")
    table.write_text(f"trial,started_at,{level},load\n", encoding="utf-8")
    return [description, table]


def format_template(*, specimen: bool = False, video: bool = False) -> str:
    """Text of a description whose required values are empty."""
    lines = [*_list_keys(Description, ["version", "name", "source"]), ""]
    if specimen:
        lines += ["specimen:", "  motion: # what moves", *_list_keys(Motion, indent=4)]
        lines += ["  load: # what moves it", *_list_keys(Quantity, indent=4)]
    else:
        lines += ["finger:", *_list_keys(DeclaredFinger, indent=2)]
        lines += ["", *_list_keys(Description, ["noise_sd_rad"])]
    if video:
        scale = ("metres_per_pixel", "markers", "marker_diameter_m")
        needed = ("fps", "dots") if specimen else ("fps", *scale)
        names = [*needed] if specimen else [*needed, "marker_colour"]
        lines += ["", "camera:", *_list_keys(Camera, names, indent=2, needed=needed)]
    return HEAD + "\n".join(lines) + "\n"


def _list_keys(
    section: type[BaseModel],
    names: list[str] | None = None,
    *,
    indent: int = 0,
    needed: tuple[str, ...] = (),
) -> Iterator[str]:
    """Lines of a section: empty keys, or comments."""
    for name in names or list(section.model_fields):
        field = section.model_fields[name]
        if field.description:
            yield " " * indent + _format_key(name, field, field.is_required() or name in needed)


def _format_key(name: str, field: FieldInfo, required: bool) -> str:
    example = json.dumps(field.examples[0]) if field.examples else ""
    if name == "version":
        return f"version: {example}"
    if required:
        return f"{name}: # {field.description}" + (f", as in {example}" if example else "")
    return f"# {name}: {example} # {field.description}"
