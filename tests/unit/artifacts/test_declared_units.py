import numpy as np
import xarray as xr

from softfinger.artifacts.declared_units import state_in_declared_units, state_sizes
from softfinger.artifacts.verdict import Estimate, StatedEffect, Verdict
from softfinger.units import Units

PARAMETERS = ["k_v", "c_v", "c_p", "q_ini"]
SIZE = 20.0  # mm a radian


def make(**attrs):
    angles = xr.Dataset(
        {"joint_angle": ("frame", [0.5], {"units": "rad"}),
         "load_torque": ("frame", [3.0], {"units": "N m"})},
        attrs=attrs,
    )  # fmt: skip
    values = xr.DataArray([4.0, 8.0, 100.0, 0.1], dims="parameter")
    logs = xr.DataArray(
        [[*np.log([4.0, 8.0, 100.0]), 0.1], [0.2, 0.3, 0.4, 0.01]], dims=("statistic", "parameter")
    )
    population = xr.Dataset(
        {"centre": values, "quantile_value": logs, "unsure": ("parameter", [True] * 4)},
        coords={"parameter": PARAMETERS, "statistic": ["mu", "sigma"]},
    )
    residuals = xr.Dataset({"residual_power": ("x", [1e-4], {"units": "rad2"})})
    verdict = {
        "residual_rms_rad": {"baseline": 0.01, "final": None, "noise": 0.002},
        "effects": [],
    }  # fmt: skip
    tree = xr.DataTree.from_dict({"population": population, "residuals": residuals})
    return {"angles": angles, "summary": tree, "verdict": verdict}


def test_a_finger_stays_as_it_is():
    artifacts = make(load_kind="x")
    assert state_in_declared_units(artifacts) == artifacts


def test_a_specimen_is_stated_in_its_own_units():
    attrs = {"motion_quantity": "travel", "motion_unit": "mm", "load_unit": "N"}
    stated = state_in_declared_units(make(motion_per_rad=SIZE, **attrs))
    angles = stated["angles"]
    assert (float(angles["joint_angle"][0]), float(angles["load_torque"][0])) == (10.0, 3.0)
    assert angles.attrs["motion_unit"] == "mm"
    residuals = stated["summary"]["residuals"]
    np.testing.assert_allclose(residuals["residual_power"], 0.04)
    assert residuals.attrs["motion_quantity"] == "travel"
    population = stated["summary"]["population"]
    expected = [0.2, 0.4, 5.0, 2.0]  # N/mm, N s/mm, N s/mm, mm
    np.testing.assert_allclose(population["centre"], expected)
    mu, sigma = population["quantile_value"].values
    np.testing.assert_allclose([*np.exp(mu[:3]), mu[3]], expected)
    np.testing.assert_allclose(sigma, [0.2, 0.3, 0.4, 0.2])
    verdict = stated["verdict"]
    assert verdict["residual_rms_rad"] == {"baseline": 0.2, "final": None, "noise": 0.04}


def test_sizes_of_effects_are_stated_in_the_declared_units():
    size = {"mean": 0.4, "sd": 0.1, "q05": 0.2, "q95": 0.6}
    effect = StatedEffect(
        id="contact_stop",
        joints=[1],
        probability=1.0,
        parameters={
            "stop_angle_rad_1": Estimate(**size),
            "stop_stiffness_nm_per_rad_1": Estimate(mean=5.0, sd=1.0, q05=3.0, q95=7.0),
        },
        spread={"stop_angle_rad_1": 0.3},
        statement="",
        location=None,
    )
    verdict = Verdict.model_construct(effects=[effect])
    (stated,) = state_sizes(verdict, Units("mm", "N", SIZE, specimen=True)).effects
    found = stated.parameters["stop_angle_mm_1"].model_dump()
    assert found == {"mean": 8.0, "sd": 2.0, "q05": 4.0, "q95": 12.0}
    assert stated.parameters["stop_stiffness_N_per_mm_1"].mean == 0.25
    assert stated.spread == {"stop_angle_mm_1": 0.3}
    assert state_sizes(verdict, Units()).effects == [effect]
