"""Tangents of all modes of a joint.

Plain arrays, rows of columns last: only so does the compiler take several columns in one
instruction. Columns that cannot move a joint hold zeros.
"""

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.work import Nodes


@compiled
def add_responses(
    response: NDArray, d_mode: NDArray, d_rate: NDArray, d_gain: NDArray, row: NDArray
) -> None:
    """Add how the modes move, drives fixed.

    They add to a row (column,): response (mode, 3) of each.
    """
    for mode in range(response.shape[0]):
        decay, slower, unit = response[mode, 0], response[mode, 1], response[mode, 2]
        for c in range(row.size):
            row[c] += decay * d_mode[mode, c] + slower * d_rate[mode, c] + unit * d_gain[mode, c]


@compiled
def add_rates(
    response: NDArray,
    motion: NDArray,
    d_mode: NDArray,
    d_rate: NDArray,
    d_gain: NDArray,
    row: NDArray,
) -> None:
    """Add how the modes' speeds move.

    motion (mode, 3) of rate, drive and place of each.
    """
    for mode in range(response.shape[0]):
        rate, push, x = motion[mode, 0], motion[mode, 1], motion[mode, 2]
        decay, slower = rate * response[mode, 0], x + rate * response[mode, 1]
        unit = push - rate * response[mode, 2]
        for c in range(row.size):
            row[c] += unit * d_gain[mode, c] - slower * d_rate[mode, c] - decay * d_mode[mode, c]


@compiled
def add_drives(weight: NDArray, d_drive: NDArray, row: NDArray) -> None:
    """Add what the drives' changes bring.

    Changes (drive, power, column) have a weight (drive, power).
    """
    for drive in range(weight.shape[0]):
        w0, w1, w2 = weight[drive, 0], weight[drive, 1], weight[drive, 2]
        for c in range(row.size):
            row[c] += (
                w0 * d_drive[drive, 0, c] + w1 * d_drive[drive, 1, c] + w2 * d_drive[drive, 2, c]
            )


@compiled
def move_modes(response: NDArray, d_mode: NDArray, d_rate: NDArray, d_gain: NDArray) -> None:
    """Move modes' tangents to a step's end, drives fixed."""
    for mode in range(response.shape[0]):
        decay, slower, unit = response[mode, 0], response[mode, 1], response[mode, 2]
        for c in range(d_mode.shape[1]):
            d_mode[mode, c] = (
                decay * d_mode[mode, c] + slower * d_rate[mode, c] + unit * d_gain[mode, c]
            )


@compiled
def drive_modes(response: NDArray, drive: NDArray, d_drive: NDArray, d_mode: NDArray) -> None:
    """Add the drives' changes to the tangents.

    response (mode, 6): from its fourth column on, how much each power of a drive counts; drive
    (mode,): which one a mode follows.
    """
    for mode in range(response.shape[0]):
        w0, w1, w2 = response[mode, 3], response[mode, 4], response[mode, 5]
        which = drive[mode]
        for c in range(d_mode.shape[1]):
            d_mode[mode, c] += (
                w0 * d_drive[which, 0, c] + w1 * d_drive[which, 1, c] + w2 * d_drive[which, 2, c]
            )


@compiled
def sum_modes(d_mode: NDArray, row: NDArray) -> None:
    """Add the modes' tangents to a row (column,)."""
    for mode in range(d_mode.shape[0]):
        for c in range(row.size):
            row[c] += d_mode[mode, c]


@compiled
def combine_nodes(weight: NDArray, rows: NDArray, changed: NDArray, j: int) -> None:
    """Add weighted rows of joint j.

    weight (node, node) · rows (node, joint, column) are added to `changed`.
    """
    for i in range(weight.shape[0]):
        for m in range(weight.shape[1]):
            for c in range(rows.shape[2]):
                changed[i, j, c] += weight[i, m] * rows[m, j, c]


@compiled
def follow_torque(by_torque: NDArray, d_torque: NDArray, changed: NDArray, j: int) -> None:
    """Add how joint j follows the torques.

    Its nodes (node, joint, column) follow torques (node · joint, column).
    """
    joints = changed.shape[1]
    for i in range(by_torque.shape[0]):
        for m in range(by_torque.shape[1]):
            slope = by_torque[i, m]
            for c in range(changed.shape[2]):
                changed[i, j, c] += slope * d_torque[m * joints + j, c]


@compiled
def follow_slides(nodes: Nodes, i: int, way: NDArray) -> None:
    """Write how the wire's directions at a node move.

    (joint, column): past a joint it slides by what that joint and those beyond it bend.
    """
    joints = way.shape[0]
    for passed in range(joints):
        way[passed] = nodes.d_direction[i, passed]
        for n in range(4):
            turn = nodes.by_motion[i, n, passed]
            for k in range(passed, joints if turn != 0.0 else passed):
                add_scaled(turn, nodes.d_angle[n, k], way[passed])


@compiled
def add_scaled(factor: float, row: NDArray, total: NDArray) -> None:
    """Add a row (column,) times a factor to another."""
    for c in range(total.size):
        total[c] += factor * row[c]
