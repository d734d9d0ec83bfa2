"""Sketches of the finger and of the joint model.

They show what words mean, not data, so they carry no stamp.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle

from softfinger.figures.style import BLACK, BLUE, GREY, PALE, RED, SINGLE_COLUMN, styled

BEND = 0.35
"""Angle of each joint in the sketch [rad]."""
LINK, JOINT, OFFSET, REACH = 1.0, 0.3, 0.2, 1.55
"""Lengths in the sketch, in link lengths; REACH is that of the lines between which angles lie."""
Cords = tuple[tuple[float, str, float], ...]
WIRES: Cords = ((OFFSET, RED, 1), (-OFFSET, GREY, 1))
"""Distance from the middle, colour and width of what runs along the finger."""


@styled
def draw_finger_sketch(n_joint: int, *, wires: bool = True) -> Figure:
    """Draw the finger from above, maybe with wires."""
    figure = Figure(figsize=(SINGLE_COLUMN, 2.3))
    ax = figure.subplots()
    centre, heading = np.zeros(2), 0.0
    cords = WIRES if wires else ()
    draw_link(ax, centre - [LINK, 0], heading, "base", cords)
    for joint in range(1, n_joint + 1):
        draw_joint(ax, centre, heading, joint, cords)
        heading += BEND
        draw_link(ax, centre, heading, f"link {joint}", cords)
        centre = centre + LINK * along(heading)
    if wires:
        name_wires(ax)
    ax.margins(0.06)
    right, top = centre
    ax.set(aspect="equal", xlim=(-2.6, max(right, 2.4) + 0.7), ylim=(-0.8, max(top, 1.2) + 0.6))
    ax.set_axis_off()
    return figure


def name_wires(ax: Axes) -> None:
    """Name both wires and their distance."""
    ax.annotate(
        "wire: tension f", (-LINK, OFFSET), (-LINK - 0.75, OFFSET),
        arrowprops={"arrowstyle": "<-", "color": RED}, color=RED, va="center", ha="right",
    )  # fmt: skip
    ax.text(-LINK - 0.1, -OFFSET, "slack wire", color=GREY, ha="right", va="center")
    ends = {"arrowstyle": "|-|,widthA=.2,widthB=.2", "lw": 0.6}
    ax.annotate("", (-0.53, 0), (-0.53, OFFSET), arrowprops=ends)
    ax.text(-0.49, OFFSET / 2, "d", ha="left", va="center", style="italic")


def along(heading: float) -> np.ndarray:
    """Unit vector of a heading."""
    return np.array([np.cos(heading), np.sin(heading)])


def draw_link(ax: Axes, start: np.ndarray, heading: float, name: str, cords: Cords) -> None:
    """Draw one link's body, wires and markers."""
    forward, side = along(heading), along(heading + np.pi / 2)
    body = start + forward * JOINT / 2, start + forward * (LINK - JOINT / 2)
    half = 1.45 * OFFSET
    corners = [body[0] - side * half, body[1] - side * half, body[1] + side * half]
    ax.fill(*np.array([*corners, body[0] + side * half]).T, color=PALE, ec=GREY, lw=0.8, zorder=1)
    for place, colour, width in cords:
        ends = np.array([point + side * place for point in body])
        ax.plot(*ends.T, color=colour, lw=width, zorder=3)
    for share in (0.32, 0.68):
        ax.add_patch(Circle(tuple(start + forward * LINK * share), 0.055, color=BLACK, zorder=4))
    above = 0.42 if heading else -0.42  # the base has its name below, away from link 1's
    style = {"ha": "right", "va": "bottom"} if heading else {"ha": "center", "va": "top"}
    ax.text(*(start + forward * LINK / 2 + side * above), name, color=GREY, **style)


def draw_direction(ax: Axes, centre: np.ndarray, heading: float) -> None:
    """Draw a link's direction beyond its proximal joint."""
    ends = np.array([centre, centre + along(heading) * REACH])
    ax.plot(*ends.T, color=BLUE, lw=0.4, zorder=5)


def draw_joint(ax: Axes, centre: np.ndarray, heading: float, joint: int, cords: Cords) -> None:
    """Draw a constricted joint, wires, relative angle."""
    bent = heading + BEND
    for place, colour, width in (*cords, (0.0, GREY, 5)):
        ends = [
            centre - along(heading) * JOINT / 2 + along(heading + np.pi / 2) * place,
            centre + along(bent) * JOINT / 2 + along(bent + np.pi / 2) * place,
        ]
        ax.plot(*np.array(ends).T, color=colour, lw=width, solid_capstyle="butt", zorder=2)
    ax.add_patch(Circle(tuple(centre), 0.045, color="white", ec=BLUE, zorder=5))
    for direction in (heading, bent):
        draw_direction(ax, centre, direction)
    first, last = np.degrees((heading, bent))
    style = {"color": BLUE, "zorder": 5}
    size = 2 * (REACH - 0.08)
    ax.add_patch(Arc(tuple(centre), size, size, theta1=first, theta2=last, lw=1, **style))
    place = centre + along(heading + BEND / 2) * (REACH + 0.12)
    ax.text(*place, f"$q_{{{joint}}}$", ha="center", va="center", **style)


@styled
def draw_joint_model_sketch() -> Figure:
    """Draw the joint's model of springs and dashpots."""
    figure = Figure(figsize=(SINGLE_COLUMN, 1.35))
    ax = figure.subplots()
    with mpl.rc_context({"lines.linewidth": 1.0}):
        draw_rods(ax)
        draw_spring(ax, 0.6, 2.4, 0.45)
        draw_dashpot(ax, 0.6, 2.4, -0.45)
        draw_dashpot(ax, 2.9, 4.7, 0.0)
    ax.text(1.5, 0.72, "$k_v$", ha="center", va="bottom")
    ax.text(1.5, -0.78, "$c_v$", ha="center", va="top")
    ax.text(3.8, -0.33, "$c_p$", ha="center", va="top")
    for start, end, name in ((0.3, 2.65, "$q_v$"), (2.65, 5.0, "$q_p$")):
        ax.annotate("", (start, 1.3), (end, 1.3), arrowprops={"arrowstyle": "<->", "color": BLUE})
        ax.text((start + end) / 2, 1.35, name, color=BLUE, ha="center", va="bottom")
    ax.annotate(
        "τ", (4.95, 0), (5.6, 0), arrowprops={"arrowstyle": "<-", "color": RED},
        color=RED, va="center", ha="left",
    )  # fmt: skip
    ax.set(xlim=(-0.3, 6), ylim=(-1.25, 1.75))
    ax.set_axis_off()
    return figure


def draw_rods(ax: Axes) -> None:
    """Draw the wall and rods between the elements."""
    ax.plot([0, 0], [-0.8, 0.8], color=BLACK, lw=2.5)
    for x in (0.3, 2.65):
        ax.plot([x, x], [-0.45, 0.45], color=BLACK)
    rods = ((0, 0.3, 0), (2.65, 2.9, 0), (4.7, 5.0, 0))
    rods += tuple((a, b, y) for y in (0.45, -0.45) for a, b in ((0.3, 0.6), (2.4, 2.65)))
    for start, end, y in rods:
        ax.plot([start, end], [y, y], color=BLACK)


def draw_spring(ax: Axes, start: float, end: float, y: float) -> None:
    """Draw a zigzag."""
    x = np.linspace(start, end, 14)
    height = np.r_[0, 0, np.tile([0.2, -0.2], 5), 0, 0]
    ax.plot(x, y + height, color=BLACK)


def draw_dashpot(ax: Axes, start: float, end: float, y: float) -> None:
    """Draw a piston in a cup."""
    middle = (start + end) / 2
    ax.plot([start, middle], [y, y], color=BLACK)
    ax.plot([middle, middle], [y - 0.14, y + 0.14], color=BLACK, lw=2.5)
    cup = (middle - 0.3, middle + 0.3)
    ax.plot([cup[0], cup[1], cup[1], cup[0]], [y + 0.22, y + 0.22, y - 0.22, y - 0.22], color=BLACK)
    ax.plot([cup[1], end], [y, y], color=BLACK)
