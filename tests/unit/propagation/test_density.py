import numpy as np
import pytest
from scipy.stats import norm

from softfinger.faults import Fault
from softfinger.propagation.density import compute_density_array, refine_density_array
from softfinger.propagation.quantiles import compute_quantiles_array

MU, SIGMA = np.array([-1.88, -3.8777, 3.3, 0.03]), np.array([0.3957, 0.8223, 0.9, 0.02])
STEP = ([0.0], [0.04])
ANGLE = np.linspace(-0.2, 4.0, 3001)


def test_it_integrates_to_one():
    density = compute_density_array(MU, SIGMA, [0.0, 0.3, 10.0], *STEP, ANGLE)
    np.testing.assert_allclose(np.trapezoid(density, ANGLE), 1.0, atol=1e-6)


def test_refinement_ends_below_its_tolerance_or_says_so():
    density, error = refine_density_array(MU, SIGMA, [0.0, 3.0], *STEP, ANGLE)
    assert (error < 1e-6).all()
    once = compute_density_array(MU, SIGMA, [0.0, 3.0], *STEP, ANGLE)
    np.testing.assert_allclose(density, once, atol=1e-6 * once.max())
    with pytest.raises(Fault, match=r"after 5 refinements; expected 1e-30"):
        refine_density_array(MU, SIGMA, [3.0], *STEP, ANGLE[::100], tolerance=1e-30)


def test_populations_of_like_widths_are_resolved():
    """k_v and c_v almost alike in every trial: found by search to be the hardest to resolve."""
    mu, sigma = np.array([-4.0, -6.0, 1.0, 0.0]), np.array([0.03125, 0.0625, 1.0, 0.0625])
    angle = np.linspace(2.5, 4.5, 400)
    coarse = compute_density_array(mu, sigma, [3.0], [0.0], [0.0625], angle)
    fine = compute_density_array(mu, sigma, [3.0], [0.0], [0.0625], angle, fineness=2.0)
    np.testing.assert_allclose(coarse, fine, atol=1e-9 * fine.max())


def test_the_window_does_not_change_the_density():
    inside = ANGLE[300:340]
    wide = compute_density_array(MU, SIGMA, [3.0], *STEP, ANGLE)[:, 300:340]
    narrow = compute_density_array(MU, SIGMA, [3.0], *STEP, inside)
    np.testing.assert_allclose(narrow, wide, rtol=1e-6)


def test_each_time_may_have_its_own_angles():
    angle = np.stack([ANGLE[:5], ANGLE[100:105]])
    both = compute_density_array(MU, SIGMA, [1.0, 2.0], *STEP, angle)
    for row, time in enumerate([1.0, 2.0]):
        one = compute_density_array(MU, SIGMA, [time], *STEP, angle[row])
        np.testing.assert_allclose(both[row], one[0], rtol=1e-6, atol=1e-9)


def test_a_load_to_the_other_side_mirrors_the_density():
    right = compute_density_array(MU, SIGMA, [2.0], *STEP, ANGLE)
    mirrored = MU * [1, 1, 1, -1]
    left = compute_density_array(mirrored, SIGMA, [2.0], [0.0], [-0.04], -ANGLE[::-1])
    np.testing.assert_allclose(left[:, ::-1], right, atol=1e-8)


def test_a_load_to_the_other_side_mirrors_the_quantiles():
    """Also where the heavy tail of c_p lies below the angles asked for."""
    sigma = SIGMA * [1, 1, 3.5, 1]
    right = compute_quantiles_array(MU, sigma, [5.0], *STEP, [0.3, 0.6, 0.995])
    mirrored = MU * [1, 1, 1, -1]
    left = compute_quantiles_array(mirrored, sigma, [5.0], [0.0], [-0.04], [0.7, 0.4, 0.005])
    np.testing.assert_allclose(-left, right, rtol=1e-6)


def test_the_far_tail_is_that_of_c_p():
    """Far out q ≈ I/c_p: a quantile 0.99999 at 1e5 rad, from a lattice that stays small."""
    sigma = SIGMA * [1, 1, 4.0, 1]
    found = compute_quantiles_array(MU, sigma, [10.0], *STEP, [0.5, 0.99999])[0]
    far = 0.4 * np.exp(-MU[2] + 3.6 * norm.ppf(0.99999))
    assert found[1] == pytest.approx(far, rel=1e-4)
    alone = compute_quantiles_array(MU, sigma, [10.0], *STEP, [0.5])[0]
    assert found[0] == pytest.approx(alone[0], abs=1e-9)


def test_an_initial_angle_known_almost_exactly_leaves_the_others_spread():
    blurred = compute_density_array(MU, SIGMA * [1, 1, 1, 0.02], [5.0], *STEP, ANGLE)
    exact = compute_density_array(MU, SIGMA * [1, 1, 1, 1e-6], [5.0], *STEP, ANGLE)
    assert np.abs(blurred - exact).max() < 1e-4 * exact.max()


def test_nothing_is_said_of_an_unknown_population():
    assert np.isnan(compute_density_array(MU * np.nan, SIGMA, [5.0], *STEP, ANGLE)).all()
    assert np.isnan(compute_quantiles_array(MU * np.nan, SIGMA, [5.0], *STEP, [0.5])).all()


@pytest.mark.parametrize("cut", [1.0, 2.5])
def test_truncation_ends_the_tail_of_c_p(cut):
    # no elastic spread and no initial spread worth the name: q = const + 0.4/c_p
    sigma = np.array([1e-3, 1e-3, 0.9, 1e-3])
    ends = np.exp(-MU[2] + np.array([-cut, cut]) * 0.9) * 0.4
    rest = 0.04 * np.exp(1.88) + 0.03
    quantile = compute_quantiles_array(MU, sigma, [10.0], *STEP, [0.0005, 0.9995], cut)[0]
    assert quantile[0] > rest + ends[0] - 0.005
    assert quantile[1] < rest + ends[1] + 0.005
    whole = compute_quantiles_array(MU, sigma, [10.0], *STEP, [0.0005, 0.9995])[0]
    assert whole[1] > rest + ends[1] + 0.005


def test_quantiles_invert_the_distribution():
    probability = np.array([0.01, 0.5, 0.9])
    quantile = compute_quantiles_array(MU, SIGMA, [0.0, 8.0], *STEP, probability)
    np.testing.assert_allclose(quantile[0], norm(0.03, 0.02).ppf(probability), atol=1e-7)
    fine = np.linspace(-0.2, quantile[1, 2], 20001)
    below = np.trapezoid(compute_density_array(MU, SIGMA, [8.0], *STEP, fine)[0], fine)
    assert below == pytest.approx(0.9, abs=1e-6)
