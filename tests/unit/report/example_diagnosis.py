"""Artifacts of a diagnosis, small and with hand-made numbers, made from their declarations."""

import numpy as np
import xarray as xr

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs import (
    free_form,
    laws,
    location,
    masking,
    measurement,
    ranking,
    repair,
)

NAMES = ["second_retardation", "wire_friction", "gravity"]
LABELS = {
    "model": ["base", "final"],
    "effect": NAMES,
    "other_effect": NAMES,
    "effect_set": ["", *NAMES],
    "refused_effect": ["temperature"],
    "replicate": np.arange(9),
    "phase": ["loading", "rest"],
    "window": np.array([0.0, 0.1, 1.0, 10.0]),
    "parameter": ["log_k_v", "log_c_v", "log_c_p", "q_ini"],
    "covariate": ["tension_n", "trial"],
    "ci_prob": np.array([0.5, 0.9]),
    "bound": ["lower", "upper"],
    "quantile": np.array([0.05, 0.5, 0.95]),
    "level": np.array([0.02, 0.04]),
}

VERDICT = {
    "version": 1,
    "campaign": "example",
    "decision": "named",
    "effects": [
        {
            "id": "second_retardation",
            "joints": [2],
            "probability": 0.98,
            "parameters": {"retardation_time_s": {"mean": 5.9, "sd": 0.4, "q05": 5.2, "q95": 6.6}},
            "statement": "Joint 2 keeps relaxing on a second time scale, with probability 0.98.",
            "location": None,
        }
    ],
    "equivalent": [],
    "location": None,
    "elpd": {"baseline": 100.0, "final": 220.0, "difference": 120.0, "se": 15.0},
    "residual_rms_rad": {"baseline": 0.0065, "final": 0.0030, "noise": 0.0030},
    "explained_spread": {"log_k_v": {"1": 0.62}},
    "not_testable": ["temperature"],
    "free_form": None,
    "n_trials": 5,
    "set_aside": [],
    "next_experiment": None,
    "explained": [
        {
            "effects": ["second_retardation"],
            "gain_nats": 120.0,
            "share": 0.9,
            "amplitudes_cover_zero": False,
        }
    ],
    "remaining": {"rms_over_noise": 1.02, "p_value": 0.4, "where": "nowhere more than by chance"},
    "not_tried": [{"id": "temperature", "reason": "temperature was not logged"}],
    "warnings": [],
    "measurement": [
        {
            "id": "outliers",
            "joints": [],
            "trials": ["trial_002"],
            "size": {"share": 0.01},
            "evidence": 31.0,
            "statement": "1 % of the frames are gross errors, and are left out.",
        }
    ],
}


def fill(spec, joints, trials, attrs):
    """Every declared variable, with numbers between its bounds."""
    rng = np.random.default_rng(5)
    labels = LABELS | {"joint": joints, "trial": trials}
    sizes = {name: len(values) for name, values in labels.items()} | {"bin": 31}
    variables = {}
    for name, declared in spec.variables.items():
        shape = [sizes[dim] for dim in declared.dims]
        low, high = max(declared.at_least, -1.0), min(declared.at_most, 1.0)
        values = rng.uniform(low, high, shape)
        if declared.kind == "text":
            values = np.full(shape, "temperature was not logged")
        elif declared.kind == "truth value":
            values = np.ones(shape, bool)
        elif declared.kind == "whole number":
            values = np.full(shape, 2)
        variables[name] = (declared.dims, values)
    coords = {name: labels[name] for name in spec.coords if name in labels}
    return xr.Dataset(variables, coords, attrs)


def make_repair(joints, trials, attrs):
    filled = fill(repair.SPEC, joints, trials, attrs)
    time = np.broadcast_to(np.geomspace(0.03, 30, filled.sizes["bin"]), filled["time"].shape)
    recorded = 0.4 - 0.3 * np.exp(-time[:, None, :] / np.arange(1, len(joints) + 1)[:, None])
    final = recorded + 0.001 * np.sin(7 * time[:, None, :])
    base = final - 0.02 * np.exp(-time[:, None, :])
    alone = recorded.shape[0] < 2
    reach = np.array([-0.05, 0.0, 0.05])[:, None, None, None] * (np.nan if alone else 1.0)
    band = np.stack([model + reach for model in (base, final)])
    return filled.assign(
        load=(("trial", "bin"), np.full(time.shape, 0.04)),
        predicted_quantile=(("model", "quantile", "trial", "joint", "bin"), band),
        time=(("trial", "bin"), time),
        since_change=(("trial", "bin"), time),
        recorded_angle=(("trial", "joint", "bin"), recorded),
        fitted_angle=(("model", "trial", "joint", "bin"), np.stack([base, final])),
        bin_noise_sd=(("trial", "joint", "bin"), np.full(recorded.shape, 0.002)),
    )


def make_free_form(joints, attrs):
    place = np.linspace(-1.0, 2.0, 41)
    value = 0.002 * np.outer(np.arange(1, len(joints) + 1), place * np.abs(place))
    measured = {
        "elpd_difference": 101.0,
        "elpd_se": 12.0,
        "excess": 0.01,
        "excess_without": 0.4,
    }
    shape = xr.Dataset(
        {
            "value": (("quantity", "place"), value),
            "sd": (("quantity", "place"), 0.0003 * (1 + np.abs(value) / 0.004)),
            **measured,
        },
        coords={"quantity": [f"joint_angle_{j}" for j in joints], "place": place},
        attrs={**attrs, "argument": "rate_rad_per_s", "gain_nats": 119.0},
    )
    assert list_faults(free_form.SPEC, shape) == []
    return shape


def make_measurement(angles, attrs):
    """The second trial is noisy and has gross errors; the noise grows with the deflection."""
    shape = angles.sizes["trial"], angles.sizes["frame"]
    joints = angles["joint"].values
    distance = np.zeros(shape)
    distance[1, :4] = 50.0
    factor = np.ones((shape[0], joints.size))
    factor[1] = 3.0
    found = xr.Dataset(
        {
            "present": (("trial", "joint"), np.ones(factor.shape, bool)),
            "used": (("trial", "frame"), distance == 0),
            "repeated": (("trial", "frame"), np.zeros(shape, bool)),
            "saturated": (("trial", "frame"), np.zeros(shape, bool)),
            "outlier_distance": (("trial", "frame"), distance),
            "frame_scale": (("trial", "frame"), np.ones(shape)),
            "trial_factor": (("trial", "joint"), factor),
            "noise_sd": ("joint", np.full(joints.size, 0.002)),
            "noise_autocorrelation": ("joint", np.full(joints.size, 0.3)),
            "noise_white": ("joint", np.zeros(joints.size)),
            "noise_correlation": (("joint", "other_joint"), np.eye(joints.size)),
            "noise_per_rad": ((), 2.0),
            "noise_per_rate": ((), 0.0),
            "window_count": ("joint", np.full(joints.size, 12)),
            "component_size": ("component", [0.01]),
            "component_evidence": ("component", [31.0]),
            "hum_frequency": ("hum", np.zeros(0)),
        },
        {
            "trial": angles["trial"],
            "joint": joints,
            "other_joint": joints,
            "component": ["outliers"],
        },
        attrs,
    )
    assert list_faults(measurement.SPEC, found) == []
    return found


def make_laws(attrs):
    """A free moment arm for all joints, and a spring's law in joint 2."""
    place = np.tile(np.linspace(0.0, 1.5, 31), (2, 1))
    value = 1.0 + np.array([[-0.2], [0.4]]) * place
    found = xr.Dataset(
        {
            "argument": (("law", "place"), place),
            "value": (("law", "place"), value),
            "low": (("law", "place"), value - 0.05),
            "high": (("law", "place"), value + 0.05),
            "effect": ("law", ["moment_arm", "strain_stiffening"]),
            "argument_name": ("law", ["angle_rad", "angle_rad"]),
            "kind": ("law", ["factor", "factor"]),
            "joint": ("law", [0, 2]),
        },
        attrs=attrs,
    )
    assert list_faults(laws.SPEC, found) == []
    return found


def make_diagnosis(angles):
    joints, trials = angles["joint"].values, angles["trial"].values
    attrs = {"campaign": "example", "source": "synthetic", "decision": "named"}
    more = {"effects": "second_retardation", "load_unit": "N m"}
    ranked = fill(ranking.SPEC, joints, trials, attrs)
    ranked["best_gain"][:] = [120.0, 3.0, -0.5]
    ranked["needed_gain"] = 8.0
    return {
        "ranking": ranked,
        "location": fill(location.SPEC, joints, trials, attrs),
        "masking": fill(masking.SPEC, joints, trials, attrs),
        "repair": make_repair(joints, trials, attrs | more),
        "free_form": make_free_form(joints, attrs),
        "measurement": make_measurement(angles, attrs),
        "laws": make_laws(attrs),
        "verdict": VERDICT,
    }
