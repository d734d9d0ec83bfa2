"""Artifacts of the declared shapes, drawn from simple formulae: 5 trials, 3 joints, 41 frames."""

import numpy as np
import xarray as xr

from softfinger.report.material import Material
from softfinger.summary import judge_run, summarise
from softfinger.summary.config import read_config

PARAMETERS = ["k_v", "c_v", "c_p", "q_ini"]
CENTRE = np.array([-2.4, -3.6, 3.0, 0.02])
SPREAD = np.array([0.2, 0.5, 0.7, 0.01])
QUANTILES = [0.05, 0.25, 0.5, 0.75, 0.95]
LOAD = 0.04
CONFIG = {
    "seed": 7,
    "campaign": "/somewhere/of/ours",
    "estimation": {"r_hat_max": 1.01, "ess_min": 400.0, "divergences_max": 0},
    "report": {
        "ci_prob": 0.9,
        "pareto_k_max": 0.7,
        "shared_residual_max": 2.0,
        "coverage_tolerance": 0.05,
    },
}

NOTE = "The noise includes what the residual shows. The load log scatters by 0.5 %: 0.05 N at 10 N."


def creep(parameters, time, load):
    """The step solution; parameters (..., 4) on their own scale."""
    k_v, c_v, c_p, q_ini = np.moveaxis(np.asarray(parameters)[..., None, :], -1, 0)
    return load / k_v * (1 - np.exp(-k_v / c_v * time)) + load / c_p * time + q_ini


def make_parameters(n_trial, n_joint, seed=1):
    draws = CENTRE + SPREAD * np.random.default_rng(seed).standard_normal((n_trial, n_joint, 4))
    draws[..., :3] = np.exp(draws[..., :3])
    return draws


def make_angles(n_trial=5, n_joint=3, n_frame=41, *, load_kind="tension_n", load_scale=1.0):
    parameters = make_parameters(n_trial, n_joint)
    parameters[..., :3] *= load_scale
    time = np.broadcast_to(np.linspace(0, 30, n_frame), (n_trial, n_frame))
    level = LOAD * load_scale * (1 + (np.arange(n_trial) % 2 if load_kind == "command" else 0))
    level = np.broadcast_to(level, n_trial)
    angle = creep(parameters, time[:, None], level[:, None, None])
    angle += 0.003 * np.random.default_rng(2).standard_normal(angle.shape)
    flag = np.zeros(angle.shape, np.uint8)
    angle[-1, 0, 5], flag[-1, 0, 5] = np.nan, 1
    angle[0, -1, 7], flag[0, -1, 7] = np.nan, 4
    joint = np.arange(1, n_joint + 1)
    return xr.Dataset(
        {
            "time": (("trial", "frame"), time),
            "joint_angle": (("trial", "joint", "frame"), angle),
            "joint_angle_covariance": (
                ("trial", "frame", "joint", "other_joint"),
                np.full((n_trial, n_frame, n_joint, n_joint), np.nan),
            ),
            "angle_flag": (("trial", "joint", "frame"), flag),
            "load_time": (("trial", "knot"), np.tile([0.0, 30.0], (n_trial, 1))),
            "load_torque": (("trial", "knot"), np.repeat(level[:, None], 2, axis=1)),
            "load_kind": ("trial", [load_kind] * n_trial),
            "started_at": ("trial", np.arange(n_trial) * 120.0),
            "covariate_value": (("trial", "covariate"), 20.0 + np.zeros((n_trial, 1))),
            "link_length": ("joint", np.full(n_joint, 0.025)),
            "link_mass": ("joint", np.full(n_joint, 0.005)),
            "link_centre": ("joint", np.full(n_joint, 0.0125)),
            "link_inertia": ("joint", np.full(n_joint, 2.6e-7)),
            "joint_length": ((), 0.008),
            "wire_offset": ((), 0.005),
            "set_aside_reason": ("set_aside_trial", ["video/trial_x.avi: no frame can be read"]),
        },
        coords={
            "trial": [f"trial_{i:03d}" for i in range(1, n_trial + 1)],
            "joint": joint,
            "other_joint": joint,
            "covariate": ["temperature_c"],
            "set_aside_trial": ["trial_x"],
        },
        attrs={
            "campaign": "example of a campaign",
            "source": "synthetic",
            "camera": 1,
            "noise_sd_rad": 0.003,
        },
    )


def make_markers(n_trial=2, n_frame=41):
    names = ["base_1", "base_2", "link_1_1", "link_1_2", "link_2_1", "link_2_2"]
    time = np.linspace(0, 30, n_frame)
    heading = np.linspace(0, 1, len(names)) * np.linspace(0, 1, n_frame)[:, None]
    along = 60 * np.arange(len(names))
    position = np.stack([100 + along * np.cos(heading), 300 - along * np.sin(heading)], axis=-1)
    shape = (n_trial, n_frame, len(names))
    return xr.Dataset(
        {
            "time": (("trial", "frame"), np.broadcast_to(time, (n_trial, n_frame))),
            "marker_position": (
                ("trial", "frame", "marker", "axis"),
                np.broadcast_to(position, (*shape, 2)),
            ),
            "marker_position_sd": (("trial", "frame", "marker"), np.full(shape, 0.02)),
            "marker_flag": (("trial", "frame", "marker"), np.zeros(shape, np.uint8)),
            "set_aside_reason": ("trial", [""] * n_trial),
        },
        coords={
            "trial": [f"trial_{i:03d}" for i in range(1, n_trial + 1)],
            "marker": names,
            "axis": ["x", "y"],
        },
    )


def make_least_squares(angles):
    trial, joint = angles["trial"], angles["joint"]
    estimate = make_parameters(trial.size, joint.size)
    if str(angles["load_kind"].values[0]) == "command":
        estimate[..., :3] *= float(angles["load_torque"].min()) / LOAD
    value = np.concatenate([np.log(estimate[..., :3]), estimate[..., 3:]], axis=-1)
    kept = np.ones(estimate.shape, bool)
    kept[0, 0, 2] = False
    dims = ("trial", "joint", "parameter")
    return xr.Dataset(
        {
            "estimate": (dims, estimate),
            "estimate_sd": (dims, 0.01 * estimate),
            "kept": (dims, kept),
            "residual_rms": (("trial", "joint"), np.full(estimate.shape[:2], 0.003)),
            "population_mean": (("joint", "parameter"), value.mean(axis=0)),
            "population_sd": (
                ("joint", "parameter"),
                value.std(axis=0, ddof=1) if len(value) > 1 else np.full(value.shape[1:], np.nan),
            ),
        },
        coords={"trial": trial, "joint": joint, "parameter": PARAMETERS},
    )


def make_posterior(angles, least_squares, n_chain=4, n_draw=60):
    rng = np.random.default_rng(3)
    joint, trial = angles["joint"], angles["trial"]
    shape = (n_chain, n_draw, joint.size)
    mean, sd = (least_squares[f"population_{name}"].values for name in ("mean", "sd"))
    sd = np.where(np.isfinite(sd), sd, SPREAD)
    groups = {"posterior": {}, "prior": {}}
    for place, name in enumerate(["log_k_v", "log_c_v", "log_c_p", "q_ini"]):
        error = sd[:, place] / np.sqrt(trial.size)
        hyper = {
            f"mu_{name}": mean[:, place] + error * rng.standard_normal(shape),
            f"sigma_{name}": sd[:, place] * np.exp(0.3 * rng.standard_normal(shape)),
        }
        groups["posterior"] |= {key: (("chain", "draw", "joint"), v) for key, v in hyper.items()}
        wide = mean[:, place] + rng.standard_normal((1, 50, joint.size))
        groups["prior"][f"mu_{name}"] = (("chain", "draw", "joint"), wide)
        spread = 0.3 * np.exp(rng.standard_normal(wide.shape))
        groups["prior"][f"sigma_{name}"] = (("chain", "draw", "joint"), spread)
        own = least_squares["estimate"].values[..., place]
        own = own if name == "q_ini" else np.log(own)
        draws = own + 0.01 * sd[:, place] * rng.standard_normal((n_chain, n_draw, *own.shape))
        groups["posterior"][name] = (("chain", "draw", "trial", "joint"), draws)
    noise = {
        "noise_sd": 0.003 * np.exp(0.01 * rng.standard_normal(shape)),
        "noise_autocorrelation": 0.3 + 0.02 * rng.standard_normal(shape),
        "noise_white": np.zeros(shape),
    }
    groups["posterior"] |= {key: (("chain", "draw", "joint"), v) for key, v in noise.items()}
    coords = {"joint": joint.values, "trial": trial.values}
    trees = {name: xr.Dataset(variables, coords=coords) for name, variables in groups.items()}
    counted = {"chain": np.arange(n_chain), "draw": np.arange(n_draw)}
    trees["posterior"] = trees["posterior"].assign_coords(counted)
    trees["sample_stats"] = xr.Dataset(
        {"diverging": (("chain", "draw"), np.zeros((n_chain, n_draw), bool))}
    )
    tree = xr.DataTree.from_dict(trees)
    tree.attrs["note"] = NOTE
    return tree


def make_sampling(joints):
    names = [f"{level}_log_k_v[{joint}]" for level in ("mu", "sigma") for joint in joints.values]
    count = len(names)
    return xr.Dataset(
        {
            "r_hat": ("quantity", np.linspace(1.0, 1.043, count)[::-1]),
            "ess_bulk": ("quantity", np.linspace(900.0, 600.0, count)),
            "ess_tail": ("quantity", np.linspace(800.0, 350.0, count)),
            "divergences": ((), 0),
        },
        coords={"quantity": names},
        attrs={"r_hat_max": 1.01, "ess_min": 400.0, "divergences_max": 0, "verdict": "red"},
    )


def make_bands(angles, n_time=31):
    protocols = np.unique(angles["load_torque"].values[:, -1])
    joint, time = angles["joint"].values, 30 * np.linspace(0, 1, n_time) ** 2
    shape = (protocols.size, joint.size, n_time)
    middle = 0.4 * (1 - np.exp(-time)) + 0.002 * time + np.zeros(shape)
    width = np.array([-1.6, -0.7, 0, 0.7, 1.6]) * 0.05
    quantiles = middle[..., None] + width
    both = ("estimate", "protocol", "joint", "time")
    twice = np.broadcast_to(middle, (2, *shape))
    levels, windows = [0.5, 0.9], ["whole", "first_second"]
    scored = ("estimate", "protocol", "window", "joint")
    covered = np.broadcast_to(levels, (2, protocols.size, 2, joint.size, 2)) - 0.01
    bounds = np.stack([covered - 0.05, np.minimum(covered + 0.04, 1)], axis=-1)
    model = np.stack([quantiles * 1.02, quantiles])
    of_trial = np.searchsorted(protocols, angles["load_torque"].values[:, -1]) + 1
    return xr.Dataset(
        {
            "joint_angle_mean": (both, twice),
            "joint_angle_sd": (both, np.full(twice.shape, 0.05)),
            "joint_angle_quantile": ((*both, "quantile"), model),
            "predicted_quantile": ((*both, "quantile"), model),
            "recorded_mean": (both[1:], middle),
            "recorded_sd": (both[1:], np.full(shape, 0.05)),
            "recorded_quantile": ((*both[1:], "quantile"), quantiles * 0.99),
            "recorded_n": (both[1:], np.full(shape, 5)),
            "coverage": ((*scored, "ci_prob"), covered),
            "coverage_bound": ((*scored, "ci_prob", "bound"), bounds),
            "crps": (scored, np.full(covered.shape[:-1], 0.02)),
            "protocol_of_trial": ("trial", [f"protocol_{i}" for i in of_trial]),
        },
        coords={
            "estimate": ["two_stage", "posterior"],
            "protocol": [f"protocol_{i + 1}" for i in range(protocols.size)],
            "window": windows,
            "joint": joint,
            "time": time,
            "quantile": QUANTILES,
            "ci_prob": levels,
            "bound": ["lower", "upper"],
            "trial": angles["trial"].values,
        },
        attrs={"bands_are": "in-sample: the scored trials took part in the estimates"},
    )


def make_densities(joints, n_time=4, n_angle=101):
    time = np.array([0.1, 1.0, 10.0, 30.0])[:n_time]
    centre = 0.4 * (1 - np.exp(-time)) + 0.002 * time
    sd = 0.02 + 0.002 * time
    angle = centre[:, None] + sd[:, None] * np.linspace(-4, 4, n_angle)
    density = np.exp(-0.5 * np.linspace(-4, 4, n_angle) ** 2) / (np.sqrt(2 * np.pi) * sd[:, None])
    dims, shape = ("joint", "time", "angle"), (joints.size, n_time, n_angle)
    both = np.broadcast_to(density, (2, *shape))
    return xr.Dataset(
        {
            "joint_angle": (dims, np.broadcast_to(angle, shape)),
            "density": (("estimate", *dims), both),
            "density_bound": ((*dims, "bound"), np.stack([0.9 * both[1], 1.1 * both[1]], -1)),
            "probability_shown": (("estimate", *dims[:2]), np.full((2, *shape[:2]), 0.99)),
        },
        coords={
            "estimate": ["two_stage", "posterior"],
            "joint": joints.values,
            "time": time,
            "bound": ["lower", "upper"],
        },
    )


def make_sobol(joints, n_time=31):
    time = np.linspace(0, 30, n_time)
    weight = np.stack([0.3 + 0 * time, np.exp(-2 * time), time / 30, 0.02 + np.exp(-5 * time)], -1)
    share = weight / weight.sum(axis=-1, keepdims=True)
    first = np.broadcast_to(0.97 * share, (2, joints.size, n_time, 4))
    bounds = np.stack([0.9 * first[1], first[1], np.minimum(1.1 * first[1], 1)], axis=-1)
    dims = ("joint", "time", "parameter")
    design = ("running_time", "joint", "parameter")
    shrinkage = np.broadcast_to([0.3, 0.1, 0.05, 0.01], (2, joints.size, 4))
    return xr.Dataset(
        {
            "spread_shrinkage": (("change", "estimate", *design), np.stack([shrinkage] * 2)[None]),
            "spread_shrinkage_quantile": (
                ("change", *design, "quantile"),
                np.stack([0.9 * shrinkage, shrinkage, 1.1 * shrinkage], -1)[None],
            ),
            "first_order": (("estimate", *dims), first),
            "total": (("estimate", *dims), first / 0.97),
            "first_order_quantile": ((*dims, "quantile"), bounds),
            "angle_sd": (("estimate", *dims[:2]), np.broadcast_to(0.1 + time, first.shape[:-1])),
        },
        coords={
            "estimate": ["two_stage", "posterior"],
            "joint": joints.values,
            "time": time,
            "parameter": PARAMETERS,
            "quantile": [0.05, 0.5, 0.95],
            "change": ["halved"],
            "running_time": [1.0, 30.0],
        },
        attrs={"definition": "variance-based indices", "truncation": "none"},
    )


def make_assumptions(joints, n_time=21):
    time = np.geomspace(1e-4, 30, n_time)
    gap = np.stack([1e-2 * np.exp(-time / 0.1), 0.1 * (1 - np.exp(-time))])
    gap = gap[:, None] * np.ones((joints.size, 1))
    angle, reached = np.linspace(0, 1.6, 9), np.full((4, joints.size), 0.5)
    return xr.Dataset(
        {
            "gap_largest_at": (("cause", "joint", "time"), gap),
            "gap_rms_at": (("cause", "joint", "time"), gap / 2),
            "arm_growth": ("angle", 0.8 * np.sin(angle / 2) + np.cos(angle / 2) - 1),
            "angle_reached": (("trial", "joint"), reached),
            "torque_growth": (("trial", "joint"), reached / 3),
            "fitted_change": (("trial", "joint", "parameter"), np.full((*reached.shape, 4), -0.2)),
            "statement": ("sentence", ["Inertia lasts 0.5 s.", "The torque grows by 17 %."]),
        },
        coords={
            "cause": ["inertia", "moment_arm"],
            "joint": joints.values,
            "time": time,
            "angle": angle,
            "parameter": PARAMETERS,
        },
        attrs={"tension_n": 8.0},
    )


def make_shapley(joints, n_time=31):
    time = np.linspace(0, 30, n_time)
    weight = np.stack([0.3 + 0 * time, np.exp(-2 * time), time / 30, 0.02 + np.exp(-5 * time)], -1)
    share = np.broadcast_to(weight / weight.sum(axis=-1, keepdims=True), (joints.size, n_time, 4))
    bounds = np.stack([0.9 * share, share, np.minimum(1.1 * share, 1)], axis=-1)
    correlation = np.eye(4) + np.diag([0.3, -0.4, 0.0], 1) + np.diag([0.3, -0.4, 0.0], -1)
    spread = np.array([-0.2, 0.0, 0.2]) * (1 - np.eye(4))[..., None]
    between = np.broadcast_to(correlation[..., None] + spread, (joints.size, 4, 4, 3))
    pair = ("joint", "parameter", "other_parameter")
    return xr.Dataset(
        {
            "shapley": (("joint", "time", "parameter"), share),
            "shapley_quantile": (("joint", "time", "parameter", "quantile"), bounds),
            "correlation": (pair, between[..., 1]),
            "correlation_quantile": ((*pair, "quantile"), between),
        },
        coords={
            "joint": joints.values,
            "time": time,
            "parameter": PARAMETERS,
            "other_parameter": PARAMETERS,
            "quantile": [0.05, 0.5, 0.95],
        },
        attrs={"definition": "Shapley effects", "protocol": "protocol_1"},
    )


def make_artifacts(**options):
    angles = make_angles(**options)
    least_squares = make_least_squares(angles)
    artifacts = {
        "angles": angles,
        "markers": make_markers(),
        "least_squares": least_squares,
        "posterior": make_posterior(angles, least_squares),
        "sampling": make_sampling(angles["joint"]),
        "bands": make_bands(angles),
        "densities": make_densities(angles["joint"]),
        "sobol": make_sobol(angles["joint"]),
        "shapley": make_shapley(angles["joint"]),
        "assumptions": make_assumptions(angles["joint"]),
    }
    for artifact in artifacts.values():
        artifact.attrs |= {
            "stage": "fit",
            "inputs": '{"angles": "0123456789abcdef"}',
            "code_sha256": "ab" * 32,
            "environment_sha256": "cd" * 32,
            "params_sha256": "ef" * 32,
            "seed": 7,
        }
    return artifacts


def sum_up(artifacts):
    """The artifacts with those that the rule `summarise` makes of them."""
    rest = {name: part for name, part in artifacts.items() if name not in ("checks", "summary")}
    limits, attrs = read_config(CONFIG["report"]), artifacts["angles"].attrs
    made = {
        "checks": judge_run(rest, limits, np.random.default_rng(1)),
        "summary": summarise(rest, limits, {"wire_friction": "the wire rubs"}),
    }
    for tree in made.values():
        tree.attrs |= {key: attrs[key] for key in ("campaign", "source")}
        tree.attrs |= {"ci_prob": limits.ci_prob, "stage": "summarise", "note": NOTE}
    return rest | made


def gather(artifacts):
    """What the report is written from."""
    return Material(sum_up(artifacts), CONFIG)
