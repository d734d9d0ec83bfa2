"""A trial's video."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
import xarray as xr

from softfinger.virtual_rig.config import FilmConfig, read_film_config
from softfinger.virtual_rig.render import (
    build_canvas,
    build_noise_table,
    draw_finger,
    expose_array,
)
from softfinger.virtual_rig.scene import (
    FRAME_HEIGHT_PX,
    FRAME_WIDTH_PX,
    compute_base_capsule,
    compute_capsules,
    compute_marker_position,
)
from softfinger.virtual_rig.streams import Purpose, build_generator


def film_trial(truth: xr.Dataset, config: dict, trial_index: int, path: Path, seed: int) -> None:
    """Film one trial to a video of grey frames.

    Frame k shows the finger at k / fps; movement within the exposure is ignored. The same
    arguments give the same bytes.

    Parameters
    ----------
    truth : Dataset
        joint_angle (trial, joint, frame) [rad], as from `draw_motion`.
    config
        The virtual rig's block of the configuration, or what of it pictures depend on.
    trial_index
        Place of the trial in the truth, from 0.
    path
        An ``.avi``; it appears only when it is complete.
    seed
        Root of the trials' streams.
    """
    rig = read_film_config(config)
    frames = render_frames(truth.joint_angle.isel(trial=trial_index), rig, seed, trial_index)
    with open_video(path, rig.fps, rig.video_quality) as write:
        for frame in frames:
            write(frame)


def render_frames(
    joint_angle: xr.DataArray, config: FilmConfig, seed: int, trial_index: int
) -> Iterator[np.ndarray]:
    """Render a trial's frames one by one.

    The same array is written over each time.

    Parameters
    ----------
    joint_angle : DataArray (joint, frame) [rad]

    Yields
    ------
    (row, column) uint8
    """
    angle = joint_angle.transpose("frame", "joint")
    capsules = compute_capsules(angle.values, config)
    markers = compute_marker_position(angle, config).values
    canvas = build_canvas(config, compute_base_capsule(config))
    noise_table = build_noise_table(config.camera_noise_grey)
    camera = build_generator(seed, trial_index, Purpose.CAMERA)
    keys = camera.integers(2**64, size=len(angle), dtype=np.uint64)
    picture = np.empty_like(canvas.still)
    frame = np.empty((FRAME_HEIGHT_PX, FRAME_WIDTH_PX), np.uint8)
    for key, capsule, marker in zip(keys, capsules, markers, strict=True):
        picture[:] = canvas.still
        draw_finger(picture, canvas, capsule, marker)
        expose_array(picture, noise_table, key, frame)
        yield frame


@contextmanager
def open_video(path: Path, fps: float, quality: int) -> Iterator:
    """Open a Motion-JPEG video for writing.

    It yields the function that appends a grey frame.

    Frames are compressed here and only wrapped by the writer, because its own compressor ignores
    the quality. The file gets its name when it is complete; after an exception nothing is left.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".unfinished-{path.name}")
    writer = cv2.VideoWriter(
        str(unfinished),
        cv2.CAP_FFMPEG,
        cv2.VideoWriter.fourcc(*"MJPG"),
        fps,
        (FRAME_WIDTH_PX, FRAME_HEIGHT_PX),
        [cv2.VIDEOWRITER_PROP_RAW_VIDEO, 1, cv2.VIDEOWRITER_PROP_IS_COLOR, 0],
    )

    def write(frame: np.ndarray) -> None:
        compressed = cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        if not writer.write(compressed.reshape(1, -1)):
            raise OSError(f"{path}: a frame could not be written; is the disk full?")

    try:
        if not writer.isOpened():
            raise OSError(
                f"{path}: the video cannot be opened for writing; is the folder writable?"
            )
        yield write
        writer.release()
        unfinished.replace(path)
    finally:
        writer.release()
        unfinished.unlink(missing_ok=True)
