import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.three_element import (
    compute_elastic_basis_array,
    compute_joint_angle_array,
    compute_joint_angle_gradient_array,
)

TIME = np.linspace(0.0, 30.0, 7)


def test_step_is_the_papers_formula():
    angle = compute_joint_angle_array(0.1, 0.02, 20.0, 0.03, TIME, [0.0], [0.04])
    paper = 0.04 / 0.1 * -np.expm1(-5.0 * TIME) + 0.04 / 20.0 * TIME + 0.03
    np.testing.assert_allclose(angle, paper, rtol=1e-14)


def test_leading_dimensions_broadcast_and_padding_stays_nan():
    rng = np.random.default_rng(1)
    k_v, c_v, c_p, q_ini = np.exp(rng.normal(size=(4, 5, 3)))
    time = np.tile(TIME, (5, 1))
    time[2, 4:] = np.nan
    load_time = np.tile([0.0, 10.0, 12.0], (5, 1))
    load_torque = rng.normal(size=(5, 3))
    angle = compute_joint_angle_array(
        k_v, c_v, c_p, q_ini, time[:, None], load_time[:, None], load_torque[:, None]
    )
    assert angle.shape == (5, 3, 7)
    assert np.isnan(angle[2, :, 4:]).all()
    assert np.isfinite(np.delete(angle, 2, axis=0)).all()
    parameters = (value[3, 1] for value in (k_v, c_v, c_p, q_ini))
    one = compute_joint_angle_array(*parameters, TIME, load_time[3], load_torque[3])
    np.testing.assert_array_equal(angle[3, 1], one)


def test_gradient_is_the_limit_of_differences():
    parameters = np.array([np.log(0.1), np.log(0.02), np.log(20.0), 0.03])
    load = ([0.5, 0.5, 8.0, 20.0], [0.0, 0.04, 0.01, 0.03])

    def simulate(values):
        return compute_joint_angle_array(*np.exp(values[:3]), values[3], TIME, *load)

    gradient = compute_joint_angle_gradient_array(
        *np.exp(parameters[:3]), parameters[3], TIME, *load
    )[1]
    for k, step in enumerate(1e-5 * np.eye(4)):
        difference = (simulate(parameters + step) - simulate(parameters - step)) / 2e-5
        np.testing.assert_allclose(gradient[:, k], difference, atol=1e-10)


def test_no_flow_is_an_infinite_dashpot():
    angle = compute_joint_angle_array(0.1, 0.02, np.inf, 0.0, [1e4], [0.0], [0.04])
    np.testing.assert_allclose(angle, 0.4, rtol=1e-15)


def test_basis_keeps_its_digits_where_the_rate_is_tiny():
    basis, slope = compute_elastic_basis_array(1e-12, [1.0, 2.0], [0.0, 2.0], [0.0, 2.0])
    np.testing.assert_allclose(basis, [0.5e-12, 2e-12], rtol=1e-11)
    np.testing.assert_allclose(slope, basis, rtol=1e-11)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"c_v": -0.5}, r"c_v = -0.5: it must be positive and finite \[N m s/rad\]"),
        ({"k_v": 0.0}, r"k_v = 0: it must be positive"),
        ({"q_ini": np.nan}, r"q_ini = nan: it must be finite \[rad\]"),
        ({"time": [0.0, 2.0, 1.0]}, r"time\[2\] = 1 s runs backwards"),
    ],
)
def test_impossible_input_is_refused_with_value_and_bound(change, sentence):
    good = {"k_v": 0.1, "c_v": 0.02, "c_p": 20.0, "q_ini": 0.0, "time": [0.0, 1.0]}
    with pytest.raises(Fault, match=sentence):
        compute_joint_angle_array(**{**good, **change}, load_time=[0.0], load_torque=[0.04])
