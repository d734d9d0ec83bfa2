"""The style that every figure shares."""

import functools
import hashlib
import io
import re
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

STYLE_FILE = Path(__file__).with_name("softfinger.mplstyle")
SINGLE_COLUMN, DOUBLE_COLUMN = 85 / 25.4, 170 / 25.4
"""Journal column widths [inch], the unit of matplotlib."""

BLACK, GREY, PALE = "#000000", "#767676", "#cccccc"
BLUE, RED, GREEN, ORANGE, SKY, PINK = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#E69F00",
    "#56B4E9",
    "#CC79A7",
)
RECORDED, POSTERIOR, TWO_STAGE = BLACK, BLUE, RED
ESTIMATE_COLOURS = {"posterior": POSTERIOR, "two_stage": TWO_STAGE}
ESTIMATE_LABELS = {"posterior": "posterior", "two_stage": "two-stage (the paper's way)"}
CLIP = re.compile(rb'<clipPath id="([^"]+)">(.*?)</clipPath>', re.DOTALL)
CLIP_NAME = re.compile(rb'(clipPath id="|url\(#)([^")]+)("|\))')
NUMBER = re.compile(rb"-?\d+\.\d+")
PARAMETER_STYLES = {
    "k_v": (BLUE, "-"),
    "c_v": (ORANGE, "--"),
    "c_p": (RED, "-."),
    "q_ini": (GREEN, ":"),
}
PARAMETER_LABELS = {
    "k_v": "$k_v$",
    "c_v": "$c_v$",
    "c_p": "$c_p$",
    "q_ini": r"$q_\mathrm{ini}$",
}


def styled[**P](draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Make `draw` use the project's style, always."""

    @functools.wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with mpl.rc_context(fname=STYLE_FILE):
            return draw(*args, **kwargs)

    return wrapper


def new_figure(source: str, height: float, width: float = DOUBLE_COLUMN) -> Figure:
    """A stamped figure of `width` × `height` [inch].

    The stamp is `synthetic` or `measured`.

    The stamp is the `source` attr of the artifact that is drawn; a figure without one is refused,
    because nobody could know afterwards whether it shows a simulation.
    """
    if source not in {"synthetic", "measured"}:
        raise ValueError(
            f"source is {source!r}; a figure must be of 'synthetic' or 'measured' data"
        )
    figure = Figure(figsize=(width, height))
    colour = RED if source == "synthetic" else GREY
    figure.suptitle(source, x=0.995, ha="right", color=colour, weight="bold")
    return figure


def get_source(dataset: xr.Dataset) -> str:
    """The `source` attr, or an empty string."""
    return str(dataset.attrs.get("source", ""))


def label_load_unit(angles: xr.Dataset) -> str:
    """Unit of the load, or `command`.

    `N m` for a torque; `command` where the load is one or only assumed.

    >>> label_load_unit(xr.Dataset({"load_kind": ("trial", ["command", "command"])}))
    'command'
    """
    if "load_unit" in angles.attrs:  # of a specimen
        return str(angles.attrs["load_unit"])
    kinds = set(angles["load_kind"].values.astype(str).tolist())
    return "N m" if kinds <= {"tension_n", "torque_nm"} else "command"


def label_motion(dataset: xr.Dataset) -> str:
    """Label of the motion, with its unit.

    >>> label_motion(xr.Dataset()), label_motion(xr.Dataset(attrs={"motion_quantity": "strain"}))
    ('joint angle [rad]', 'strain [rad]')
    """
    return f"{dataset.attrs.get('motion_quantity', 'joint angle')} [{get_motion_unit(dataset)}]"


def get_motion_unit(dataset: xr.Dataset) -> str:
    """Unit of the motion, [rad] or declared."""
    return str(dataset.attrs.get("motion_unit", "rad"))


def label_parameter_unit(parameter: str, load_unit: str, motion_unit: str = "rad") -> str:
    """Unit of a parameter.

    It is that of the load, per unit of motion.

    >>> label_parameter_unit("c_p", "N m"), label_parameter_unit("q_ini", "command")
    ('N m s/rad', 'rad')
    >>> label_parameter_unit("k_v", "MPa", "1"), label_parameter_unit("k_v", "Pa", "1/Pa")
    ('MPa', 'Pa/(1/Pa)')
    """
    if parameter == "q_ini":
        return motion_unit
    per = "" if motion_unit == "1" else f"/{motion_unit}"
    per = f"/({motion_unit})" if set(motion_unit) & set("/* ") else per
    return f"{load_unit}{'' if parameter == 'k_v' else ' s'}{per}"


def build_joint_axes(
    figure: Figure, n_joint: int, n_row: int = 1, *, sharex: str | bool = True, sharey: bool = False
) -> np.ndarray:
    """Lay out axes (row, joint), a column per joint.

    Beyond four joints, each has a row.
    """
    if n_joint <= 4:
        return figure.subplots(n_row, n_joint, squeeze=False, sharex=sharex, sharey=sharey)
    return figure.subplots(n_joint, n_row, squeeze=False, sharex=sharex, sharey=sharey).T


def measure_joint_rows(n_joint: int, n_row: int) -> int:
    """Number of rows that `build_joint_axes` lays out."""
    return n_row if n_joint <= 4 else n_joint


def label_log_axis(axis: Axis) -> None:
    """Label a short logarithmic axis 1, 2, 5."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def render_figure(figure: Figure, form: str = "svg") -> bytes:
    """Bytes of a figure as `svg`, `pdf` or `png`.

    The same figure gives the same bytes.
    """
    metadata = {
        "svg": {"Date": None, "Creator": None},
        "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
        "png": {"Software": None},
    }[form]
    buffer = io.BytesIO()
    with mpl.rc_context(fname=STYLE_FILE):
        figure.savefig(buffer, format=form, metadata=metadata)
    content = buffer.getvalue()
    return name_clips(shorten_paths(content)) if form == "svg" else content


def name_clips(svg: bytes) -> bytes:
    """Name an SVG's clipping areas by what is written of them.

    Matplotlib names them by digits that rounding may change from one run to the next.

    >>> name_clips(b'<clipPath id="p0"><rect x="1"/></clipPath><g clip-path="url(#p0)"/>')
    b'<clipPath id="pc4738c4f85"><rect x="1"/></clipPath><g clip-path="url(#pc4738c4f85)"/>'
    """
    names = {
        found[1]: b"p" + hashlib.sha256(found[2]).hexdigest()[:10].encode()
        for found in CLIP.finditer(svg)
    }
    return CLIP_NAME.sub(lambda found: found[1] + names.get(found[2], found[2]) + found[3], svg)


def shorten_paths(svg: bytes) -> bytes:
    """Round an SVG's path coordinates to 0.01 pt.

    Nobody sees it, and it saves half of their bytes.

    >>> shorten_paths(b'<path d="M 1.234567 2.0 L -0.001 3"/>')
    b'<path d="M 1.23 2 L 0 3"/>'
    """
    return re.sub(rb' d="[^"]*"', lambda path: NUMBER.sub(_round, path[0]), svg)


def _round(number: re.Match[bytes]) -> bytes:
    return b"%g" % (round(float(number[0]), 2) + 0.0)


def save_figure(figure: Figure, path: Path | str) -> None:
    """Write a figure to `path` (.svg, .pdf, .png)."""
    path = Path(path)
    path.write_bytes(render_figure(figure, path.suffix.removeprefix(".")))
