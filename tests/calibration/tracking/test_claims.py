"""Claimed against actual error: over noise, size, phase and blur, and through a real codec."""

import cv2
import numpy as np
import pytest
from benchmarks._discs import compute_position_bound, draw_disc, expose

from softfinger.tracking.body import Body
from softfinger.tracking.fit import FIT_QUALITY, NOISE_VARIANCE, UNIT_XX, UNIT_YY
from softfinger.tracking.follow import follow_discs_array
from softfinger.tracking.tracker import Tracker
from softfinger.tracking.uncertainty import claim_sd_array

LEVEL, CONTRAST = 190.0, -130.0
PHASES = [(0.02 + 0.24 * i, 0.07 + 0.24 * j) for i in range(4) for j in range(4)]
DRAWS = 100  # a phase: 1600 a cell


def fit(picture, known, start):
    fitted, quality = np.full((1, 8), np.nan), np.empty((1, len(FIT_QUALITY)))
    one = np.ones(1)
    follow_discs_array(
        picture[:, :, None], one, known, 4.0 * one, one > 0, start[None], fitted, quality
    )
    return fitted[0], quality[0]


def draw(phase, radius, blur, divisions=20):
    size = int(2 * radius + 20)
    centre = size // 2 + np.array(phase)
    light = LEVEL + CONTRAST * draw_disc((size, size + 3), tuple(centre), radius, blur, divisions)
    spread = np.hypot(blur, 12**-0.5)
    known = np.array([[*centre, CONTRAST, radius, spread, LEVEL, 0.0, 0.0]])
    return light, centre, known


@pytest.mark.slow
@pytest.mark.parametrize("blur", [0.0, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("radius", [3.0, 5.0, 7.0, 10.0])
def test_the_claim_is_true_at_every_noise_and_unbiased_at_every_phase(radius, blur):
    rng = np.random.default_rng(int(10 * radius + 100 * blur))
    scenes = [draw(phase, radius, blur) for phase in PHASES]
    for noise in (1.0, 2.0, 5.0, 10.0):
        error, claimed = [], []
        for light, centre, known in scenes:
            for _ in range(DRAWS):
                start = centre + rng.normal(0.0, 0.3, 2)
                p, quality = fit(expose(light, noise, rng), known, start)
                error.append(p[:2] - centre)
                claimed.append(quality[[UNIT_XX, UNIT_YY]] * quality[NOISE_VARIANCE])
        sd = np.sqrt(np.mean(claimed))
        assert 0.9 < sd / np.sqrt(np.mean(np.square(error))) < 1.1, noise
        bound = compute_position_bound((0.3, 0.4), radius, blur, CONTRAST, noise)
        assert np.sqrt(np.mean(np.square(error))) / bound < 1.2, noise


@pytest.mark.slow
@pytest.mark.parametrize("blur", [0.0, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("radius", [3.0, 5.0, 7.0, 10.0])
def test_the_centre_has_no_bias_at_any_phase(radius, blur):
    for phase in PHASES:
        light, centre, known = draw(phase, radius, blur, 100)
        p, quality = fit(light, known, centre)
        p, quality = fit(light, p[None], p[:2])
        bias = np.abs(p[:2] - centre).max()
        sd = np.sqrt(quality[UNIT_XX] * (1.0 + 1.0 / 12.0))  # at the lowest noise, 1 of 255
        assert bias < max(0.3 * sd, 0.0005), phase


@pytest.mark.slow
@pytest.mark.parametrize("noise", [1.5, 3.0, 6.0])
@pytest.mark.parametrize("codec_quality", [60, 75, 90])
def test_the_claim_is_true_in_coded_pictures(noise, codec_quality):
    """Two rigid links wander; their pictures go through JPEG."""
    rng = np.random.default_rng(7 * codec_quality)
    home = np.array([[60.0, 60.0], [110.0, 62.0], [160.0, 100.0], [205.0, 120.0]])
    known = np.zeros((4, 8))
    known[:, :2], known[:, 2:6] = home, [CONTRAST, 8.5, 0.7, LEVEL]
    body = Body.measure([[0, 1], [2, 3]], home)
    tracker = Tracker(np.ones(1), known, body, np.full(4, 4.0))
    truth = home + np.repeat(np.cumsum(0.4 * rng.standard_normal((500, 2, 2)), axis=0), 2, axis=1)
    fits = []
    for places in truth:
        light = np.full((190, 270), LEVEL)
        for place in places:  # coarser ones deviate from discs by a third of the lowest noise
            light += CONTRAST * draw_disc(light.shape, tuple(place), 8.5, 0.6, 24)
        coded = cv2.imencode(
            ".jpg", expose(light, noise, rng), [cv2.IMWRITE_JPEG_QUALITY, codec_quality]
        )[1]
        fitted, quality = tracker.follow(cv2.imdecode(coded, cv2.IMREAD_GRAYSCALE)[:, :, None])
        fits.append(np.column_stack([fitted[:, :2], quality]))
    table = np.array(fits)
    sd = claim_sd_array(table[..., :2], table[..., 2:], np.zeros(500, bool), body)
    ratio = np.sqrt(np.mean(np.square(sd)) / np.mean(np.square(table[..., :2] - truth)))
    assert 0.9 < ratio < 1.1
