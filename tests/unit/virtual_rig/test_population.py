import numpy as np
import pytest
from scipy import stats

from softfinger.mechanics import PARAMETERS
from softfinger.virtual_rig.population import draw_finger_parameters

# Typed from the paper's table again: row σ, row μ; c_v, c_p, k_v; joints 1 to 3.
SIGMA = {"c_v": [0.5232, 0.4838, 0.8223], "c_p": [0.7011, 0.8496], "k_v": [0.1973, 0.2238, 0.3957]}
MU = {"c_v": [-3.6635, -3.6476, -3.8777], "c_p": [2.8538, 3.1129], "k_v": [-2.4441, -2.2986, -1.88]}


@pytest.fixture(scope="module")
def drawn():
    return draw_finger_parameters(2000, seed=4)


@pytest.mark.parametrize("name", PARAMETERS)
@pytest.mark.parametrize("joint", [1, 2, 3])
def test_draws_follow_the_table(drawn, name, joint):
    sigma, mu = SIGMA.get(name, [0.01] * 3), MU.get(name, [0.02] * 3)
    expected = dict(enumerate(zip(mu, sigma, strict=True), start=1)).get(joint, (3.3, 0.9))
    values = drawn[name].sel(joint=joint).values
    normal = values if name == "q_ini" else np.log(values)
    assert stats.kstest(normal, stats.norm(*expected).cdf).pvalue > 1e-3
    given = drawn[["population_mean", "population_sd"]].sel(joint=joint, parameter=name)
    assert (float(given.population_mean), float(given.population_sd)) == expected


def test_parameters_joints_and_trials_are_independent(drawn):
    columns = [
        drawn[name].values[:, joint] if name == "q_ini" else np.log(drawn[name].values[:, joint])
        for name in PARAMETERS
        for joint in range(3)
    ]
    correlation = np.corrcoef(columns) - np.eye(12)
    assert abs(correlation).max() < 4 / np.sqrt(2000)
    successive = [np.corrcoef(column[1:], column[:-1])[0, 1] for column in columns]
    assert np.abs(successive).max() < 4 / np.sqrt(2000)


def test_the_first_trials_do_not_depend_on_how_many_follow():
    few, many = draw_finger_parameters(3, seed=9), draw_finger_parameters(5, seed=9)
    assert few.equals(many.isel(trial=slice(3)))
    assert not few.k_v.equals(draw_finger_parameters(3, seed=10).k_v)
