"""Pictures by which a person judges the tracking."""

from pathlib import Path

import cv2
import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking.video import read_frames

# Blue, green, red; colours that the colour-blind distinguish.
_LINK_COLOURS = ((115, 158, 0), (178, 114, 0), (0, 159, 230), (167, 121, 204), (233, 180, 86))
_BASE_COLOUR = (150, 150, 150)
_SUSPECT_COLOUR = (0, 94, 213)
_FINE_BITS = 4  # of a pixel, to draw with
_TRAIL = 30  # frames
_SHEET_COLUMNS = 3


def draw_overlay(picture: np.ndarray, markers: xr.Dataset, frame: int) -> np.ndarray:
    """Draw one frame's markers on its picture.

    Each link has its colour and a line through its markers; a marker is a ring with a cross on its
    centre, red where it is suspect, and the trail of the last 30 frames. A line of text gives the
    frame, its time and what is missing.

    Parameters
    ----------
    picture : (row, column, channel) uint8
    markers : Dataset
        One trial of the artifact `markers`.
    frame : int

    Returns
    -------
    (row, column, 3) uint8
    """
    canvas = picture.copy() if picture.shape[2] == 3 else np.repeat(picture, 3, axis=2)
    position = markers["marker_position"].transpose("frame", "marker", "axis").to_numpy()
    flag = markers["marker_flag"].transpose("frame", "marker").to_numpy()[frame]
    names = [str(name) for name in markers["marker"].to_numpy()]
    links = [name.rsplit("_", 1)[0] for name in names]
    size = max(5, round(min(canvas.shape[:2]) / 45))
    for number, link in enumerate(dict.fromkeys(links)):
        colour = _BASE_COLOUR if number == 0 else _LINK_COLOURS[(number - 1) % len(_LINK_COLOURS)]
        own = [k for k, name in enumerate(links) if name == link]
        _draw_line(canvas, position[frame, own], colour)
        for k in own:
            _draw_line(canvas, position[max(0, frame - _TRAIL) : frame + 1, k], colour)
            if np.isfinite(position[frame, k]).all():
                suspect = bool(flag[k] & JUMP)
                _draw_ring(canvas, position[frame, k], size, _SUSPECT_COLOUR if suspect else colour)
    missing = [name for name, bits in zip(names, flag, strict=True) if bits & MISSING]
    text = f"frame {frame}  {float(markers['time'][frame]):.3f} s"
    text += "  repeated" * bool((flag & STALE).any())
    text += f"  missing: {', '.join(missing)}" if missing else ""
    _write(canvas, text)
    return canvas


def write_overlay(video: Path, fps: float, markers: xr.Dataset, path: Path) -> None:
    """Write a trial's video with its markers.

    The format is Motion JPEG.

    Parameters
    ----------
    video : Path
    fps : float [1/s]
        The declared frame rate.
    markers : Dataset
        One trial of the artifact `markers`.
    path : Path
        An ``.avi``.
    """
    writer = None
    try:
        for frame in read_frames(video, fps):
            canvas = draw_overlay(frame.picture, markers, frame.index)
            if writer is None:
                size = (canvas.shape[1], canvas.shape[0])
                writer = cv2.VideoWriter(
                    str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*"MJPG"), fps, size
                )
                if not writer.isOpened():
                    raise Fault(f"{path}: cannot be written; check that its folder exists")
            writer.write(canvas)
    finally:
        if writer is not None:
            writer.release()


def choose_worst_frames(markers: xr.Dataset, count: int) -> np.ndarray:
    """Worst-tracked frames of a trial, in order (≤ count,).

    Missing markers count most, then suspect ones, then the claimed standard deviation.
    """
    used = np.isfinite(markers["time"].to_numpy())
    flag = markers["marker_flag"].transpose("frame", "marker").to_numpy()
    sd = markers["marker_position_sd"].transpose("frame", "marker").to_numpy()
    missing, suspect = ((flag & MISSING) > 0).sum(axis=1), ((flag & JUMP) > 0).sum(axis=1)
    worst_sd = np.nan_to_num(sd).max(axis=1)
    order = np.lexsort((np.arange(used.size), -worst_sd, -suspect, -missing))
    return np.sort(order[used[order]][:count])


def draw_contact_sheet(video: Path, fps: float, markers: xr.Dataset, count: int = 9) -> np.ndarray:
    """Draw a trial's worst-tracked frames side by side.

    Parameters
    ----------
    video : Path
    fps : float [1/s]
    markers : Dataset
        One trial of the artifact `markers`.

    Returns
    -------
    (row, column, 3) uint8
    """
    wanted = set(choose_worst_frames(markers, count).tolist())
    tiles = [
        draw_overlay(frame.picture, markers, frame.index)
        for frame in read_frames(video, fps)
        if frame.index in wanted
    ]
    columns = min(_SHEET_COLUMNS, len(tiles))
    blank = [np.full_like(tiles[0], 255)] * (-len(tiles) % columns)
    full = tiles + blank
    return np.vstack([np.hstack(full[k : k + columns]) for k in range(0, len(full), columns)])


def write_contact_sheet(video: Path, fps: float, markers: xr.Dataset, path: Path) -> None:
    """Write `draw_contact_sheet` as a picture file."""
    if not cv2.imwrite(str(path), draw_contact_sheet(video, fps, markers)):
        raise Fault(f"{path}: cannot be written; check that its folder exists")


def _to_fine(points: np.ndarray) -> np.ndarray:
    return np.round(points * 2**_FINE_BITS).astype(np.int32)


def _draw_line(canvas: np.ndarray, points: np.ndarray, colour: tuple[int, int, int]) -> None:
    seen = points[np.isfinite(points).all(axis=1)]
    if len(seen) > 1:
        cv2.polylines(canvas, [_to_fine(seen)], False, colour, 1, cv2.LINE_AA, _FINE_BITS)


def _draw_ring(
    canvas: np.ndarray, place: np.ndarray, size: int, colour: tuple[int, int, int]
) -> None:
    x, y = _to_fine(place).tolist()
    one = 2**_FINE_BITS
    cv2.circle(canvas, (x, y), size * one, colour, 2, cv2.LINE_AA, _FINE_BITS)
    cv2.line(canvas, (x - 3 * one, y), (x + 3 * one, y), colour, 1, cv2.LINE_AA, _FINE_BITS)
    cv2.line(canvas, (x, y - 3 * one), (x, y + 3 * one), colour, 1, cv2.LINE_AA, _FINE_BITS)


def _write(canvas: np.ndarray, text: str) -> None:
    (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.5, 1)
    cv2.rectangle(canvas, (0, 0), (width + 12, height + below + 8), (255, 255, 255), -1)
    place = (6, height + 5)
    cv2.putText(canvas, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.5, (0, 0, 0), 1, cv2.LINE_AA)
