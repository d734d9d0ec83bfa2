"""A drawn finger of two joints, and films of it: nothing here knows the estimator's profile."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks._discs import draw_disc, expose

from softfinger.campaign import Camera
from softfinger.faults import TrialFault
from softfinger.tracking.video import read_frames

ROWS, COLUMNS = 150, 220
SCALE = 0.0005  # m/px
LINKS = (0.030, 0.028)
PLACES = {"base": (-0.022, -0.009), "link_1": (0.007, 0.022), "link_2": (0.006, 0.014, 0.023)}
JOINT = np.array([60.0, 100.0])
RADIUS = 4.0


@dataclass(frozen=True)
class Rig:
    """A camera that looks at a finger; places of its markers at given angles; films of it."""

    camera: Camera
    link_length: tuple[float, ...]
    folder: Path
    rng: np.random.Generator

    def place(self, angles):
        """Markers (marker, 2) [px] of the finger bent by relative angles, counter-clockwise."""
        joint, heading, places = JOINT, 0.0, []
        for number, link in enumerate(PLACES):
            along = np.array([np.cos(heading), -np.sin(heading)])
            if number:
                heading += angles[number - 1]
                along = np.array([np.cos(heading), -np.sin(heading)])
            places += [joint + place / SCALE * along for place in PLACES[link]]
            if number:
                joint = joint + LINKS[number - 1] / SCALE * along
        return np.array(places)

    def draw(self, places, noise=2.0, level=180.0, contrast=-120.0, radius=RADIUS, shade=0.0):
        """Picture (row, column, 1) of discs in light that falls off by `shade` to the right."""
        light = np.full((ROWS, COLUMNS), level)
        for x, y in places:
            light += contrast * draw_disc((ROWS, COLUMNS), (x, y), radius, 0.6, 10)
        light *= 1.0 - shade * np.arange(COLUMNS) / COLUMNS
        return expose(light, noise, self.rng)[:, :, None]

    def film(self, pictures, name="trial.avi", fps=30.0, codec="FFV1"):
        """Write a video and return its path; FFV1 loses nothing."""
        path = self.folder / name
        size = (pictures[0].shape[1], pictures[0].shape[0])
        code = cv2.VideoWriter.fourcc(*codec)
        colour = pictures[0].shape[2] == 3
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, code, fps, size, colour)
        assert writer.isOpened()
        for picture in pictures:
            writer.write(picture)
        writer.release()
        return path


@pytest.fixture
def rig(tmp_path):
    camera = Camera(
        fps=30.0,
        metres_per_pixel=SCALE,
        markers=PLACES,
        marker_diameter_m=2 * RADIUS * SCALE,
        marker_colour="dark",
    )
    return Rig(camera, LINKS, tmp_path, np.random.default_rng(5))


@pytest.fixture
def rng():
    return np.random.default_rng(20)


@pytest.fixture
def read():
    """Every frame of a video."""
    return lambda path, fps=30.0: list(read_frames(path, fps))


@pytest.fixture
def refuse(read):
    """The one sentence that refuses a video; it begins with the file's name."""

    def refused(path, fps=30.0) -> str:
        with pytest.raises(TrialFault) as caught:
            read(path, fps)
        said = str(caught.value)
        assert said.startswith(path.name)
        assert "\n" not in said
        return said

    return refused
