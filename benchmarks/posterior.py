"""The hierarchical posterior: seconds, effective draws beside PyMC's own NUTS, coverage.

The paper's population, joint 3's c_p from log-normal(3.3, 0.9), under its step of 30 s, 30 frames a
second, white noise of 3 mrad unless said. The rival is PyMC's own NUTS as it comes on the plain
model: every frame in it, centred, white noise, started at the truth; one chain until `RIVAL_CPU_S`
of CPU are spent. Ours, by Gibbs sampling, has AR(1) noise and correlated joints in the model. All
CPU is counted on both sides: tuning, and what goes before it.

The sampler that ships is timed with the default configuration, from angles to a diagnosed
posterior, its compilation from the cache included. Its rivals are nutpie on a model that our pilot
fit has whitened, which also gets the pilot's CPU, and the Laplace answer of that pilot.
"""

import time
from collections.abc import Mapping

import arviz as az
import numpy as np
import pymc as pm
import pytensor.tensor as pt
import xarray as xr
from numpy.typing import NDArray

from benchmarks.rivals import laplace, nutpie_whitened
from softfinger.config import read_config
from softfinger.estimation.diagnostics import diagnose_sampling
from softfinger.inference.posterior import compile_fit, prepare_fit, sample_posterior
from softfinger.inference.sampling import Density
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.stages.linear_algebra import on_one_thread

MU = np.array(
    [
        [-2.4441, -3.6635, 2.8538, 0.02],
        [-2.2986, -3.6476, 3.1129, 0.02],
        [-1.8800, -3.8777, 3.3, 0.02],
    ]
)
SIGMA = np.array(
    [[0.1973, 0.5232, 0.7011, 0.01], [0.2238, 0.4838, 0.8496, 0.01], [0.3957, 0.8223, 0.9, 0.01]]
)
TORQUE, FPS, DURATION_S, NOISE_RAD = 0.04, 30.0, 30.0, 0.003
LIMITS = {"r_hat_max": 1.01, "ess_min": 400.0, "divergences_max": 0}
SHORT = {
    "sampler": "gibbs", "chains": 4, "tune": 100, "draws": 800, "cores": 2,
    "covariance": "independent",
    **LIMITS,
}  # fmt: skip
NUTS = SHORT | {
    "sampler": "nuts", "tune": 150, "draws": 700, "target_accept": 0.8, "max_depth": 3,
}  # fmt: skip
RIVAL_CPU_S = 3600.0
RIVAL_TUNE = 1000
RATED_DRAWS = 10_000  # of ours, a chain: half a minute
COVERED_CAMPAIGNS, COVERED_TRIALS = 20, 40
CASES = {
    "white": {"rho": 0.0},
    "AR(1) 0.3": {"rho": 0.3},
    "AR(1) 0.9": {"rho": 0.9},
    "AR(1) 0.98": {"rho": 0.98},
    "outliers": {"rho": 0.3, "outliers": 0.005},
    "gaps": {"rho": 0.3, "gaps": 0.2},
}


@on_one_thread
def measure() -> dict[str, float]:
    """Seconds of wall time from angles to a diagnosed posterior, by Gibbs sampling and NUTS."""
    angles, _ = build_campaign(100, 1)
    seconds = measure_default(angles)
    for config, key in ((SHORT, ""), (NUTS, "_by_nuts")):
        density = compile_fit(prepare_fit(angles), config)
        fit_once(angles, config | {"tune": 10, "draws": 10}, 1, density)
        start, clock = time.perf_counter(), time.process_time()
        posterior, stats = fit_once(angles, config, 2, density)
        found = diagnose(posterior, stats)
        took = time.perf_counter() - start
        print(
            f"  {config['sampler']}: {took:.1f} s, {time.process_time() - clock:.1f} s of CPU; "
            f"{config['draws']} draws a chain; verdict {found.attrs['verdict']}, {describe(found)}",
            flush=True,
        )
        if found.attrs["verdict"] == "green":
            seconds[f"posterior_seconds_to_ess_400{key}"] = took
    return seconds


def measure_default(angles: xr.Dataset) -> dict[str, float]:
    """Wall seconds of the sampler that ships, beside its pilot's Laplace answer."""
    config = read_config()["estimation"]
    fit_once(angles, config | {"tune": 10, "draws": 10}, 1)
    clock = [time.perf_counter()]
    prepared = prepare_fit(angles)
    clock.append(time.perf_counter())
    density = compile_fit(prepared, config)
    clock.append(time.perf_counter())
    posterior, stats = sample_posterior(prepared, config, np.random.default_rng(2), density)
    found = diagnose(posterior, stats)
    clock.append(time.perf_counter())
    pilot, loading, sampling = np.diff(clock)
    print(
        f"  default: pilot {pilot:.1f} s, loading compiled code {loading:.1f} s, sampling"
        f" {sampling:.1f} s; verdict {found.attrs['verdict']}, {describe(found)}",
        flush=True,
    )
    misfit = laplace.compare(prepared.recorded.candidate.fit, posterior)
    figures = {
        "posterior_laplace_seconds": float(pilot),
        "posterior_laplace_shift_sd": misfit.shift,
        "posterior_laplace_sd_ratio": misfit.sd_ratio,
    }
    if found.attrs["verdict"] == "green":
        figures["posterior_default_seconds_to_ess_400"] = clock[-1] - clock[0]
    return figures


@on_one_thread
def measure_long() -> dict[str, float]:
    """Effective draws per CPU second over the rivals'; coverage."""
    return {
        **compare_with_nutpie(),
        "posterior_ess_per_cpu_ratio_to_pymc_default": compare_with_rival(),
        **measure_coverage(),
    }


def compare_with_rival() -> float:
    """Smallest bulk ESS of μ, σ and the noise's sd per CPU second, ours over the rival's."""
    angles, true = build_campaign(100, 1)
    fit_once(angles, SHORT | {"tune": 10, "draws": 10}, 1)
    start = time.process_time()
    posterior, stats = fit_once(angles, SHORT | {"cores": 1, "draws": RATED_DRAWS}, 2)
    cpu = time.process_time() - start
    found = diagnose(posterior, stats)
    shared = [not str(name).startswith("noise_auto") for name in found["quantity"].to_numpy()]
    ours = float(found["ess_bulk"][shared].min()) / cpu
    print(f"  ours: {ours:.4g} effective draws per CPU second in {cpu:.0f} s", flush=True)
    ess, r_hat, draws, cpu = run_rival(angles, true)
    print(
        f"  rival: smallest bulk ESS {ess:.4g}, R-hat of its halves {r_hat:.3f}, of {draws} draws"
        f" in {cpu:.0f} s with {RIVAL_TUNE} of tuning, {'' if r_hat < 1.01 else 'not '}converged",
        flush=True,
    )
    return ours / (ess / cpu)


def compare_with_nutpie() -> dict[str, float]:
    """Smallest bulk ESS of μ, σ and the noise's sd per CPU second, of both."""
    angles, _ = build_campaign(100, 1)
    config = read_config()["estimation"]
    density = compile_fit(prepare_fit(angles), config)
    start = time.process_time()
    prepared = prepare_fit(angles)
    pilot = time.process_time() - start
    posterior, stats = sample_posterior(prepared, config, np.random.default_rng(2), density)
    cpu = time.process_time() - start
    found = diagnose(posterior, stats)
    shared = [not str(name).startswith("noise_auto") for name in found["quantity"].to_numpy()]
    ours = float(found["ess_bulk"][shared].min()) / cpu
    fit = prepared.recorded.candidate.fit
    rival = nutpie_whitened.run(angles, fit, TORQUE, RIVAL_CPU_S / 2, 1)
    theirs = rival.ess / (rival.cpu + pilot)
    print(
        f"  nutpie, whitened: smallest bulk ESS {rival.ess:.4g} of {rival.draws} draws, R-hat"
        f" {rival.r_hat:.3f}, {rival.cpu:.0f} s of CPU, beside {pilot:.1f} s of the pilot",
        flush=True,
    )
    return {
        "posterior_ess_per_cpu_ratio_to_nutpie_whitened": ours / theirs,
        "posterior_ess_per_cpu_of_nutpie_whitened": theirs,
        "posterior_ess_per_cpu_by_default": ours,
    }


def run_rival(angles: xr.Dataset, true: xr.Dataset) -> tuple[float, float, int, float]:
    """Sample the plain model by PyMC's own NUTS: smallest ESS, largest R-hat, draws, CPU s."""
    begin, clock = time.process_time(), []

    def watch(trace: object, draw: object) -> None:
        clock.append(time.process_time())
        if len(clock) % 100 == 0:
            print(f"  rival: iteration {len(clock)}, {clock[-1] - begin:.0f} s", flush=True)
        if clock[-1] - begin > RIVAL_CPU_S:
            raise KeyboardInterrupt

    with build_plain_model(angles):
        trace = pm.sample(
            draws=10_000, tune=RIVAL_TUNE, chains=1, cores=1, nuts_sampler="pymc",
            initvals=true, callback=watch, random_seed=1, progressbar=False,
            compute_convergence_checks=False, discard_tuned_samples=True,
        )  # fmt: skip
    kept = trace["posterior"].to_dataset()[["mu", "sigma", "noise_sd"]]
    ess = min(float(x.min()) for x in az.ess(kept, method="bulk").data_vars.values())
    halves = kept.isel(chain=0, drop=True).coarsen(draw=kept.sizes["draw"] // 2, boundary="trim")
    halves = halves.construct(draw=("chain", "draw"))  # one chain has no R-hat, its halves have
    r_hat = max(float(x.max()) for x in az.rhat(halves).data_vars.values())
    return ess, r_hat, kept.sizes["draw"], clock[-1] - begin


def build_plain_model(angles: xr.Dataset) -> pm.Model:
    """Every frame of every trial, centred, white noise; the step solution as the paper has it."""
    trials, joints, _ = angles["joint_angle"].shape
    moment = angles["time"].to_numpy()[0]
    with pm.Model() as model:
        mu = pm.Normal("mu", [-2.5, -3.5, 3.0, 0.0], [1.5, 2.0, 2.0, 0.5], shape=(joints, 4))
        sigma = pm.LogNormal("sigma", np.log([0.3, 0.3, 0.3, 0.02]), 1.0, shape=(joints, 4))
        eta = pm.Normal("eta", mu, sigma, shape=(trials, joints, 4))
        noise = pm.LogNormal("noise_sd", np.log(0.005), 1.5, shape=joints)
        k_v, c_v, c_p = (pt.exp(eta[..., k])[..., None] for k in range(3))
        motion = TORQUE / k_v * (1 - pt.exp(-k_v / c_v * moment)) + TORQUE / c_p * moment
        pm.Normal(
            "y", motion + eta[..., 3:], noise[:, None], observed=angles["joint_angle"].to_numpy()
        )
    return model


def measure_coverage() -> dict[str, float]:
    """Share of 50 and 90 % intervals of μ and σ that hold the truth, in the worst noise case."""
    shares: dict[int, list[float]] = {50: [], 90: []}
    for name, case in CASES.items():
        ranks = np.array(
            [
                rank_truth(*build_campaign(COVERED_TRIALS, seed, **case), seed)
                for seed in range(COVERED_CAMPAIGNS)
            ]
        )
        for level, held in shares.items():
            held.append(float((np.abs(ranks - 0.5) < level / 200).mean()))
        print(
            f"  {name}: of {ranks.size} intervals of 50 % {shares[50][-1]:.3f} hold the truth,"
            f" of those of 90 % {shares[90][-1]:.3f}",
            flush=True,
        )
    return {
        f"posterior_coverage_{level}": max(held, key=lambda share: abs(share - level / 100))
        for level, held in shares.items()
    }


def rank_truth(angles: xr.Dataset, true: Mapping[str, NDArray], seed: int) -> NDArray[np.float64]:
    """Share of draws below the truth: (mu and sigma, joint, parameter)."""
    posterior, _ = fit_once(angles, SHORT | {"chains": 2, "draws": 400}, seed)
    ranks = []
    for level in ("mu", "sigma"):
        names = [f"{level}_{name}" for name in ("log_k_v", "log_c_v", "log_c_p", "q_ini")]
        draws = np.stack([posterior[name].to_numpy() for name in names], axis=-1)
        ranks.append((draws < true[level]).mean(axis=(0, 1)))
    return np.array(ranks)


def fit_once(
    angles: xr.Dataset, config: dict, seed: int, density: Density | None = None
) -> tuple[xr.Dataset, xr.Dataset]:
    """Prepare and sample: the posterior and the sampler's statistics."""
    return sample_posterior(prepare_fit(angles), config, np.random.default_rng(seed), density)


def diagnose(posterior: xr.Dataset, stats: xr.Dataset) -> xr.Dataset:
    """Diagnose the sampling against the usual limits."""
    tree = xr.DataTree.from_dict({"posterior": posterior, "sample_stats": stats})
    return diagnose_sampling(tree, LIMITS)


def describe(found: xr.Dataset) -> str:
    """Worst R-hat and effective draws in words."""
    worst = float(found["r_hat"].max())
    bulk, tail = (float(found[f"ess_{kind}"].min()) for kind in ("bulk", "tail"))
    return (
        f"R-hat at most {worst:.4f}, effective draws at least {bulk:.0f} (bulk), {tail:.0f} (tail)"
    )


def build_campaign(
    trials: int, seed: int, rho: float = 0.0, outliers: float = 0.0, gaps: float = 0.0
) -> tuple[xr.Dataset, dict[str, NDArray]]:
    """Draw a campaign; what is true of it, as the plain model's variables.

    Parameters
    ----------
    outliers, gaps
        Share of frames of a trial that a wrong value (30 times the noise) or nothing stands in.
    """
    rng = np.random.default_rng(seed)
    moment = np.arange(0.0, DURATION_S, 1 / FPS)
    names = [f"trial_{i + 1:05d}" for i in range(trials)]
    recording = build_recording(moment, [0.0, DURATION_S], [TORQUE] * 2, len(MU), names)
    own = draw_parameters(MU, SIGMA, recording, rng)
    noise = describe_noise(np.full(len(MU), NOISE_RAD), np.full(len(MU), rho))
    angles = draw_angles(recording, own, noise, rng)
    value = angles["joint_angle"].to_numpy().copy()
    shape = (trials, 1, len(moment))
    struck = (rng.uniform(size=shape) < outliers) & (rng.uniform(size=value.shape) < 0.5)
    value += struck * 30 * NOISE_RAD * rng.standard_normal(value.shape)
    value[np.broadcast_to(rng.uniform(size=shape) < gaps, value.shape)] = np.nan
    logs = [np.log(own[name].to_numpy()) for name in ("k_v", "c_v", "c_p")]
    eta = np.stack([*logs, own["q_ini"].to_numpy()], axis=-1)
    true = {"mu": MU, "sigma": SIGMA, "eta": eta, "noise_sd": np.full(len(MU), NOISE_RAD)}
    return angles.assign(joint_angle=(("trial", "joint", "frame"), value)), true
