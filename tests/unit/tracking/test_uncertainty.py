import numpy as np

from softfinger.tracking.body import Body
from softfinger.tracking.uncertainty import (
    claim_sd_array,
    compute_excess_array,
    measure_variance_factor_array,
)

LINKS = [[0, 1], [2, 3, 4]]
HOME = np.array([[10.0, 10.0], [40.0, 10.0], [60.0, 10.0], [80.0, 30.0], [100.0, 50.0]])


def scatter(rng, sd, frames=900):
    """Rigid links that swing about, their markers placed with the given sd (marker,)."""
    turn = np.cumsum(0.02 * rng.standard_normal(frames))
    centre = HOME.mean(axis=0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    moved = np.einsum("ijt,mj->tmi", rotation, HOME - centre) + centre
    return moved + np.asarray(sd)[:, None] * rng.standard_normal(moved.shape)


def measure(position, claimed, stale=None):
    body = Body.measure(LINKS, HOME)
    stale = np.zeros(len(position), bool) if stale is None else stale
    variance = np.full(position.shape[:2], claimed**2)
    return measure_variance_factor_array(position, variance, stale, body)


def test_a_true_claim_stays(rng):
    factor = measure(scatter(rng, np.full(5, 0.02)), 0.02)
    np.testing.assert_allclose(factor, 1.0, atol=0.12)


def test_each_link_is_corrected_by_its_own_scatter(rng):
    factor = measure(scatter(rng, [0.02, 0.02, 0.03, 0.03, 0.03], 5000), 0.02)
    np.testing.assert_allclose(factor, [1.0, 1.0, 2.25, 2.25, 2.25], rtol=0.1)


def test_a_few_frames_change_little_and_faults_and_repeats_nothing(rng):
    few = scatter(rng, np.full(5, 0.06), 4)
    assert measure(few, 0.02).max() < 4.0
    position = scatter(rng, np.full(5, 0.02))
    position[300, 1] += 9.0
    position[400:450, 3] = np.nan
    np.testing.assert_allclose(measure(position, 0.02), 1.0, atol=0.12)
    repeated = np.repeat(scatter(rng, np.full(5, 0.02)), 2, axis=0)
    stale = np.tile([False, True], 900)
    np.testing.assert_allclose(measure(repeated, 0.02, stale), 1.0, atol=0.12)
    assert measure(repeated, 0.02).max() < 0.7


def test_markers_without_a_rigid_mate_keep_their_claim(rng):
    position = scatter(rng, np.full(5, 0.05))
    body = Body.measure([[k] for k in range(5)], HOME)
    factor = measure_variance_factor_array(
        position, np.full((900, 5), 0.02**2), np.zeros(900, bool), body
    )
    np.testing.assert_array_equal(factor, 1.0)


def test_a_frame_that_fits_badly_claims_less(rng):
    position = scatter(rng, np.full(5, 0.02), 300)
    quality = np.broadcast_to([4e-5, 4e-5, 0.0, 10.0, 1.2], (300, 5, 5)).copy()
    quality[:, :, 3] *= 1.0 + 0.1 * rng.standard_normal((300, 5))
    quality[50, 2, 4] = 6.0
    position[70, 4], quality[70, 4] = np.nan, np.nan
    sd = claim_sd_array(position, quality, np.zeros(300, bool), Body.measure(LINKS, HOME))
    np.testing.assert_allclose(sd[50, 2] / sd[51, 2], np.sqrt(5.0), rtol=0.2)
    np.testing.assert_allclose(np.delete(sd, 50, axis=0)[:60], 0.02, rtol=0.2)
    assert np.isnan(sd[70, 4])
    assert np.isfinite(np.delete(sd, 70, axis=0)).all()
    np.testing.assert_allclose(compute_excess_array(quality)[50], [1, 1, 5, 1, 1], rtol=0.4)
