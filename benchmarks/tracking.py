"""Tracking against the Cramér–Rao bound and beside its peers, on the same drawn pictures.

Discs are drawn by supersampled coverage. Peers get the sensible settings for these pictures: the
threshold midway between disc and background, the diameter that the discs have. Rivals in windows
get what ours gets: places, radii, level and contrast in the first picture. The rival of both ratios
is the most accurate one for the error, and the fastest one that follows in windows for the time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import trackpy

from benchmarks._discs import compute_position_bound, draw_disc, expose
from benchmarks.rivals.grey_moments import GreyMoments
from benchmarks.rivals.trackpy_windows import TrackpyWindows
from softfinger.tracking.body import Body
from softfinger.tracking.disc import PARAMETERS
from softfinger.tracking.fit import FIT_QUALITY, MARGINS, NOISE_VARIANCE, UNIT_XX, UNIT_YY
from softfinger.tracking.follow import follow_discs_array
from softfinger.tracking.tracker import Tracker

ROWS, COLUMNS = 480, 640
LEVEL, CONTRAST, BLUR = 190.0, -130.0, 0.6
RADII = np.repeat([5.0, 6.0, 7.0, 8.0], 2)
FRAMES = 480  # the ratio to the bound is known to 1 %
HALF = 24  # pixels that a disc is drawn on, to either side
CLIPS = (0.05, 0.075, 0.1, 0.125, 0.15, 0.2)  # of which a rival in windows gets its best
FRAMES_OF_TRACKPY = 20  # it takes some 50 ms a frame


@dataclass(frozen=True)
class Film:
    """Frames with discs that wander about a pixel a frame, where they are, and the bound there."""

    pictures: Sequence[np.ndarray]
    truth: np.ndarray  # (frame, disc, 2)
    bound: np.ndarray  # (disc,)


def measure() -> dict[str, float]:
    """Measure accuracy, claimed accuracy and speed."""
    rng = np.random.default_rng(20261121)
    films = [draw_film(noise, rng) for noise in (3.0, 5.0)]
    figures: dict[str, float] = {}
    accuracy = {name: [way(film) for film in films] for name, way in WAYS.items()}
    ours = accuracy["softfinger"]
    figures["tracking_rms_over_crlb"] = max(a.ratio for a in ours)
    figures["tracking_fps"] = min(1.0 / a.seconds for a in ours)
    figures["tracking_fps_ratio_to_opencv_threshold"] = compare(
        ours, accuracy["opencv_threshold"], lambda mine, its: its.seconds / mine.seconds, min
    )
    in_windows = [accuracy[name] for name in ("grey_moments", "trackpy_in_windows")]
    figures["tracking_rms_ratio_to_best_rival"] = max(
        compare(ours, found, lambda mine, its: mine.ratio / its.ratio, max)
        for name, found in accuracy.items()
        if name != "softfinger"
    )
    figures["tracking_time_ratio_to_best_rival"] = max(
        compare(ours, found, lambda mine, its: mine.seconds / its.seconds, max)
        for found in in_windows
    )
    for name, found in accuracy.items():
        if name != "softfinger":
            figures[f"tracking_rms_over_crlb_of_{name}"] = max(a.ratio for a in found)
            figures[f"tracking_fps_of_{name}"] = min(1.0 / a.seconds for a in found)
        figures[f"tracking_bias_px_of_{name}"] = max(a.bias for a in found)
    figures["tracking_claimed_over_actual_worst"] = max(
        (
            measure_claim(noise, radius, rng)
            for noise in (1, 2, 4, 7, 10)
            for radius in (3, 5, 7, 10)
        ),
        key=lambda ratio: abs(np.log(ratio)),
    )
    return figures


def draw_film(noise: float, rng: np.random.Generator) -> Film:
    """Draw eight isolated discs that wander, a little more than a pixel a frame."""
    columns, rows = np.meshgrid(np.linspace(90, 550, 4), [140.0, 340.0])
    start = np.stack([columns.ravel(), rows.ravel()], axis=1)
    truth = start + np.cumsum(rng.normal(0.0, 0.8, (FRAMES, len(start), 2)), axis=0)
    pictures = []
    for places in truth:
        light = np.full((ROWS, COLUMNS), LEVEL)
        for (x, y), radius in zip(places, RADII, strict=True):
            left, top = int(x) - HALF, int(y) - HALF
            around = light[top : top + 2 * HALF, left : left + 2 * HALF]
            around += CONTRAST * draw_disc(around.shape, (x - left, y - top), radius, BLUR)
        pictures.append(expose(light, noise, rng))
    bound = [compute_position_bound((0.3, 0.4), r, BLUR, CONTRAST, noise) for r in RADII]
    return Film(pictures, truth, np.array(bound))


@dataclass(frozen=True)
class Accuracy:
    """Rms error over the bound, mean error [px] and CPU seconds a frame of one way to track."""

    ratio: float
    bias: float
    seconds: float


def follow(film: Film) -> Accuracy:
    """Track with this project's tracker, each disc on its own."""
    known = np.zeros((len(RADII), len(PARAMETERS)))
    known[:, :2] = film.truth[0]
    known[:, 2:6] = np.stack([0 * RADII + CONTRAST, RADII, 0 * RADII + 0.7, 0 * RADII + LEVEL], 1)
    links = [[k] for k in range(len(RADII))]
    frames = [picture[:, :, None] for picture in film.pictures]
    body, margin = Body.measure(links, known[:, :2]), np.full(len(RADII), MARGINS[-1])
    Tracker(np.ones(1), known.copy(), body, margin).follow(frames[0])
    tracker = Tracker(np.ones(1), known, body, margin)
    start = time.process_time()
    found = np.array([tracker.follow(frame)[0][:, :2] for frame in frames])
    return rate(film, found, (time.process_time() - start) / len(frames))


def compare(
    ours: list[Accuracy],
    theirs: list[Accuracy],
    divide: Callable[[Accuracy, Accuracy], float],
    choose: Callable[..., float],
) -> float:
    """The worst ratio over the films."""
    return choose(divide(mine, its) for mine, its in zip(ours, theirs, strict=True))


def follow_by(rival: type) -> Callable:
    """Build a way to track from a class that follows in windows; its best clip counts."""

    def track(film: Film) -> Accuracy:
        tried = []
        for clip in CLIPS:
            given = (film.truth[0], RADII, LEVEL, CONTRAST, clip)
            rival(*given).follow(film.pictures[0])
            follower, start = rival(*given), time.process_time()
            found = np.array([follower.follow(picture) for picture in film.pictures])
            tried.append(rate(film, found, (time.process_time() - start) / len(film.pictures)))
        best = min(tried, key=lambda accuracy: accuracy.ratio)
        seconds = min(accuracy.seconds for accuracy in tried)  # the clip costs nothing
        return Accuracy(best.ratio, best.bias, seconds)

    return track


def locate_by(locate: Callable[[np.ndarray], np.ndarray], frames: int = FRAMES) -> Callable:
    """Build a way to track from a function that gives all places (place, 2) in a picture."""

    def track(film: Film) -> Accuracy:
        locate(film.pictures[0])
        start = time.process_time()
        places = [locate(picture) for picture in film.pictures[:frames]]
        seconds = (time.process_time() - start) / frames
        found = np.array(
            [
                [near[np.argmin(np.hypot(*(near - place).T))] for place in truth]
                for near, truth in zip(places, film.truth, strict=False)
            ]
        )
        return rate(film, found, seconds)

    return track


def rate(film: Film, found: np.ndarray, seconds: float) -> Accuracy:
    """Compare places (frame, disc, 2) with the truth."""
    error = found - film.truth[: len(found)]
    ratio = np.sqrt(np.mean((error / film.bound[:, None]) ** 2))
    return Accuracy(float(ratio), float(np.abs(error.mean(axis=(0, 1))).max()), seconds)


def locate_by_threshold(picture: np.ndarray) -> np.ndarray:
    """Centroids of connected components under the middle threshold."""
    _, dark = cv2.threshold(picture, LEVEL + CONTRAST / 2, 255, cv2.THRESH_BINARY_INV)
    _, _, stats, centroids = cv2.connectedComponentsWithStats(dark)
    return centroids[1:][stats[1:, cv2.CC_STAT_AREA] > 20]


def build_blob_detector() -> Callable[[np.ndarray], np.ndarray]:
    """OpenCV's SimpleBlobDetector for dark blobs of these sizes."""
    settings = cv2.SimpleBlobDetector.Params()
    settings.minThreshold, settings.maxThreshold, settings.thresholdStep = 80, 170, 10
    settings.filterByArea, settings.minArea, settings.maxArea = True, 30, 400
    settings.filterByConvexity = settings.filterByInertia = False
    settings.minDistBetweenBlobs = 10
    detector = cv2.SimpleBlobDetector.create(settings)
    return lambda picture: np.array([blob.pt for blob in detector.detect(picture)])


def locate_by_trackpy(picture: np.ndarray) -> np.ndarray:
    """Refined features of trackpy with a mask wider than the largest disc."""
    found = trackpy.locate(picture, 19, invert=True, minmass=2000, engine="numba")
    return found[["x", "y"]].to_numpy()


WAYS: dict[str, Callable[[Film], Accuracy]] = {
    "softfinger": follow,
    "grey_moments": follow_by(GreyMoments),
    "trackpy_in_windows": follow_by(TrackpyWindows),
    "opencv_threshold": locate_by(locate_by_threshold),
    "opencv_blob_detector": locate_by(build_blob_detector()),
    "trackpy": locate_by(locate_by_trackpy, FRAMES_OF_TRACKPY),
}


def measure_claim(noise: float, radius: float, rng: np.random.Generator) -> float:
    """Claimed over actual rms error of 1500 drawn discs, at 15 sub-pixel phases."""
    size = int(2 * radius + 20)
    error, claimed = [], []
    for _ in range(15):
        centre = size // 2 + rng.random(2)
        light = LEVEL + CONTRAST * draw_disc((size, size + 3), tuple(centre), radius, BLUR)
        known = np.array([[*centre, CONTRAST, radius, 0.7, LEVEL, 0.0, 0.0]])
        for _ in range(100):
            fitted, quality = np.full((1, len(PARAMETERS)), np.nan), np.empty((1, len(FIT_QUALITY)))
            follow_discs_array(
                expose(light, noise, rng)[:, :, None],
                np.ones(1),
                known,
                np.full(1, MARGINS[-1]),
                np.ones(1, bool),
                centre[None] + rng.normal(0.0, 0.3, (1, 2)),
                fitted,
                quality,
            )
            error.append(fitted[0, :2] - centre)
            claimed.append(quality[0, [UNIT_XX, UNIT_YY]] * quality[0, NOISE_VARIANCE])
    return float(np.sqrt(np.mean(claimed) / np.mean(np.square(error))))
