"""How often the 90 % intervals of the quick run's hyperparameters hold the virtual rig's truth.

``python -m benchmarks._coverage N`` films, tracks and fits the quick configuration under N seeds
and prints the share of intervals that hold the truth, by kind of hyperparameter. Beside it stands
the share of the textbook intervals (Student's t, χ²) of somebody who knows every trial's true
parameters: what falls short of that is the fit's, the rest is the luck of the draw.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.stats import chi2, t

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import truth as truth_spec
from softfinger.campaign import list_tables, read_campaign
from softfinger.config import read_config
from softfinger.provenance import PROJECT
from softfinger.stages.angles import angles
from softfinger.stages.film import film
from softfinger.stages.fit import fit
from softfinger.stages.keys import choose_settings
from softfinger.stages.track import track
from softfinger.stages.virtual_rig import virtual_rig

PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def main(seeds: int) -> None:
    """Run the quick configuration under so many seeds and print the coverage."""
    config = read_config(PROJECT / "config/quick.yaml")
    held, ideal = np.moveaxis([run_once(config, seed) for seed in range(1, seeds + 1)], 1, 0)
    for k, statistic in enumerate(("mu", "sigma")):
        for p, parameter in enumerate(PARAMETERS):
            inside = held[:, k, :, p]
            print(f"{statistic}_{parameter:8s} {inside.sum():3d} of {inside.size}")
    n, total = held.size, int(held.sum())
    print(f"all              {total} of {n}: {total / n:.3f} of the 90 % intervals hold the truth")
    print(f"true parameters  {ideal.sum()} of {n}: {ideal.mean():.3f} of the textbook intervals do")


def run_once(config: dict, seed: int) -> np.ndarray:
    """Whether each 90 % interval holds the truth: (fit and textbook, μ and σ, joint, parameter)."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        folder, truth = out / "campaign", out / "truth.nc"
        rig, tracking = config["virtual_rig"], config["tracking"]
        virtual_rig(truth=truth, folder=folder, config=rig, seed=seed)
        motion = open_artifact(truth, truth_spec.SPEC)
        trials = motion["trial"].to_numpy().tolist()
        videos = [folder / f"video/{trial}.avi" for trial in trials]
        film(truth=truth, videos=videos, config=rig, seed=seed)
        tables = list_tables(read_campaign(folder))
        shared = {"folder": folder, "tables": tables}
        track(trials=trials, videos=videos, markers=out / "markers.nc", **shared)
        angles(markers=[out / "markers.nc"], angles=out / "angles.nc", config=tracking, **shared)
        fit(
            angles=out / "angles.nc",
            posterior=out / "posterior.nc",
            config=choose_settings(config, "fit"),
            cores=config["estimation"]["cores"],
            seed=seed,
        )
        draws = open_tree(out / "posterior.nc", posterior_spec.SPEC)["posterior"].dataset
    held = []
    for statistic, true in (("mu", motion["population_mean"]), ("sigma", motion["population_sd"])):
        columns = [draws[f"{statistic}_{parameter}"] for parameter in PARAMETERS]
        low, high = (
            np.stack([c.quantile(q, ("chain", "draw")).to_numpy() for c in columns], axis=1)
            for q in (0.05, 0.95)
        )
        held.append((low <= true.to_numpy()) & (true.to_numpy() <= high))
    ideal = judge_textbook(motion)
    print(f"seed {seed}: {np.sum(held)} of {np.size(held)}, textbook {ideal.sum()}", flush=True)
    return np.array([held, ideal])


def judge_textbook(motion: xr.Dataset) -> np.ndarray:
    """Whether Student's and the χ² interval of the true parameters hold the truth."""
    natural = [motion[name].to_numpy() for name in ("k_v", "c_v", "c_p", "q_ini")]
    true = np.stack([*np.log(natural[:3]), natural[3]], axis=-1)
    n, mean, sd = len(true), motion["population_mean"], motion["population_sd"]
    spread = true.std(axis=0, ddof=1)
    rank = [
        t.cdf((mean.to_numpy() - true.mean(axis=0)) / spread * np.sqrt(n), n - 1),
        chi2.cdf((n - 1) * (spread / sd.to_numpy()) ** 2, n - 1),
    ]
    return np.abs(np.array(rank) - 0.5) <= 0.45


if __name__ == "__main__":
    main(int(sys.argv[1]))
