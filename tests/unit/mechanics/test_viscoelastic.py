import numpy as np
import pytest
import xarray as xr
from scipy.special import erfcx, gamma

from softfinger.faults import Fault
from softfinger.mechanics.viscoelastic.elements import (
    NAMED,
    Dashpot,
    Network,
    Spring,
    Springpot,
    build_network,
    burgers,
    compute_transfer_function,
    generalised_maxwell,
    generalised_voigt,
    kelvin_voigt,
    maxwell,
    parallel,
    series,
    three_element,
    zener,
)
from softfinger.mechanics.viscoelastic.laplace import compute_mittag_leffler_array
from softfinger.mechanics.viscoelastic.response import (
    compute_creep_compliance,
    compute_creep_compliance_array,
    compute_network_response_array,
    compute_relaxation_modulus,
    compute_relaxation_modulus_array,
)

TIME = np.geomspace(1e-3, 300.0, 7)


def voigt_creep(k, c):
    return -np.expm1(-TIME * k / c) / k


@pytest.mark.parametrize(
    ("network", "creep"),
    [
        (maxwell(2.0, 3.0), 1 / 2 + TIME / 3),
        (kelvin_voigt(2.0, 3.0), voigt_creep(2, 3)),
        (zener(1.0, 2.0, 3.0), 1 + voigt_creep(2, 3)),
        (three_element(0.1, 0.02, 20.0), voigt_creep(0.1, 0.02) + TIME / 20),
        (burgers(1.0, 2.0, 3.0, 4.0), 1 + voigt_creep(2, 3) + TIME / 4),
        (generalised_voigt(1.0, [2, 5], [3, 70]), 1 + voigt_creep(2, 3) + voigt_creep(5, 70)),
        (Springpot(2.0, 0.4), TIME**0.4 / 2 / gamma(1.4)),
        (
            parallel(Spring(2.0), Springpot(0.5, 0.5)),
            0.5 * (1 - erfcx(4 * np.sqrt(TIME))),
        ),
    ],
)
def test_creep_has_its_closed_form(network, creep):
    np.testing.assert_allclose(compute_creep_compliance_array(network, TIME), creep, rtol=1e-10)


@pytest.mark.parametrize(
    ("network", "impulse", "relaxation"),
    [
        (maxwell(2.0, 3.0), 0.0, 2 * np.exp(-TIME * 2 / 3)),
        (kelvin_voigt(2.0, 3.0), 3.0, np.full(7, 2.0)),
        (zener(1.0, 2.0, 3.0), 0.0, 2 / 3 + np.exp(-TIME) / 3),
        (generalised_maxwell(1.0, [2, 5], [3, 70]), 0.0,
         1 + 2 * np.exp(-TIME * 2 / 3) + 5 * np.exp(-TIME / 14)),
        # The paper's joint: an impulse c_v c_p/(c_v + c_p), then one exponential.
        (three_element(2.0, 1.0, 3.0), 0.75, 2 * (3 / 4) ** 2 * np.exp(-TIME * 2 / 4)),
        (Springpot(2.0, 0.4), 0.0, 2 * TIME**-0.4 / gamma(0.6)),
        (series(Spring(2.0), Springpot(0.5, 0.5)), 0.0, 2 * erfcx(4 * np.sqrt(TIME))),
        (parallel(Dashpot(3.0), Springpot(2.0, 0.4)), 3.0, 2 * TIME**-0.4 / gamma(0.6)),
    ],
)  # fmt: skip
def test_relaxation_has_its_closed_form(network, impulse, relaxation):
    found, regular = compute_relaxation_modulus_array(network, TIME)
    np.testing.assert_allclose(found, impulse, rtol=1e-14)
    np.testing.assert_allclose(regular, relaxation, rtol=1e-9, atol=1e-14)


def test_transfer_function_of_the_papers_joint_with_its_misprint_mended():
    k_v, c_v, c_p = 0.1, 0.02, 20.0
    s = np.array([0.3 + 0.7j, 5j, 100.0])
    expected = ((c_v + c_p) * s + k_v) / (s * (c_v * c_p * s + c_p * k_v))
    found = compute_transfer_function(three_element(k_v, c_v, c_p), s)
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_a_springpot_network_just_after_the_step():
    network = series(Spring(2.0), parallel(Springpot(1.0, 0.5), Spring(4.0)))
    creep = compute_creep_compliance_array(network, [0.0, 1e-12])
    assert creep[0] == 0.5
    np.testing.assert_allclose(creep[1], 0.5, rtol=1e-5)


def test_equal_branches_merge_and_nearly_equal_ones_stay_exact():
    same = parallel(maxwell(1.0, 1.0), maxwell(2.0, 2.0))
    merged = maxwell(3.0, 3.0)
    near = parallel(maxwell(1.0, 1.0), maxwell(2.0, 2.0 + 1e-9))
    expected = compute_creep_compliance_array(merged, TIME)
    np.testing.assert_allclose(compute_creep_compliance_array(same, TIME), expected, rtol=1e-14)
    np.testing.assert_allclose(compute_creep_compliance_array(near, TIME), expected, rtol=1e-8)


@pytest.mark.parametrize("network", [three_element(0.1, 0.02, 20.0), Springpot(2.0, 0.3)])
def test_response_to_a_step_is_the_creep_compliance(network):
    response = compute_network_response_array(network, 1.0 + TIME, [1.0], [0.04])
    expected = 0.04 * compute_creep_compliance_array(network, 1.0 + TIME - 1.0)
    np.testing.assert_allclose(response, expected, rtol=1e-10)


def test_labelled_faces():
    time = xr.DataArray(TIME, dims="time")
    creep = compute_creep_compliance(zener(1.0, 2.0, 3.0), time)
    assert creep.dims == ("time",)
    assert creep.name == "creep_compliance"
    impulse, relaxation = compute_relaxation_modulus(kelvin_voigt(2.0, 3.0), time)
    assert impulse == 3.0
    assert relaxation.dims == ("time",)


@pytest.mark.parametrize(
    ("a", "b", "x"),
    [(0.3, 1.0, 0.4), (0.7, 1.7, 0.4), (0.2, 2.0, 0.1), (1.0, 1.0, 0.5), (0.9, 0.9, 0.3)],
)
def test_mittag_leffler_is_its_series(a, b, x):
    series_sum = sum((-x) ** n / gamma(a * n + b) for n in range(120))
    np.testing.assert_allclose(compute_mittag_leffler_array(a, b, -x), series_sum, rtol=1e-11)


def test_mittag_leffler_far_out():
    x = np.geomspace(1e-6, 1e6, 25)
    half = compute_mittag_leffler_array(0.5, 1.0, -x)
    np.testing.assert_allclose(half, erfcx(x), rtol=1e-11)
    np.testing.assert_allclose(compute_mittag_leffler_array(1.0, 1.0, -x), np.exp(-x), atol=1e-11)
    far = compute_mittag_leffler_array(0.9, 1.0, -1e6)
    np.testing.assert_allclose(far, 1e-6 / gamma(0.1) - 1e-12 / gamma(-0.8), rtol=1e-9)


def test_a_model_file_spells_networks():
    network = build_network({"series": [{"parallel": ["spring", "dashpot"]}, "dashpot"]}, [1, 2, 3])
    assert network == three_element(1, 2, 3)
    assert network == build_network("three_element", [1, 2, 3])
    assert build_network({"series": ["springpot", "spring"]}, [1.0, 0.5, 2.0]) == series(
        Springpot(1.0, 0.5), Spring(2.0)
    )
    assert set(NAMED) >= {"maxwell", "kelvin_voigt", "zener", "three_element", "burgers"}


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: Spring(-1.0), "stiffness = -1: it must be positive and finite"),
        (lambda: Dashpot(0.0), "damping = 0"),
        (lambda: Springpot(1.0, 1.0), "exponent = 1: it must lie between 0 and 1"),
        (lambda: Network("series", ()), "at least one"),
        (lambda: build_network("voigt", [1.0]), "unknown viscoelastic model 'voigt'"),
        (lambda: build_network("maxwell", [1.0]), "needs more"),
        (lambda: build_network("maxwell", [1.0, 2.0, 3.0]), "needs fewer"),
        (lambda: compute_creep_compliance_array(maxwell(1, 1), [-0.5]), "time = -0.5 s"),
        (lambda: compute_relaxation_modulus_array(maxwell(1, 1), [0.0]), "after 0"),
        (lambda: compute_mittag_leffler_array(1.5, 1.0, -1.0), "a = 1.5"),
    ],
)
def test_impossible_input_is_refused(call, sentence):
    with pytest.raises(Fault, match=sentence):
        call()
