"""Coverage of μ and σ by condition of the measurement.

``python -m benchmarks.clean_coverage FOLDER N [CONDITION …]`` fits N clean campaigns of each
condition of a proof (`make concealed-clean` leaves them in results/concealed_clean/seed_1), or of
those that are named, by the default configuration, and prints the shares. Beside them are those of
the textbook intervals (Student's t, χ²) of somebody who knows every trial's true parameters: what
falls short of that is the fit's, the rest is the luck of the draw. Campaigns of fewer than four
trials are left out.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.stats import chi2, t

from softfinger.artifacts import open_tree
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.config import read_config
from softfinger.stages.fit import fit
from softfinger.stages.keys import choose_settings
from softfinger.stages.prepare import prepare_angles

PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
LEAST_TRIALS = 4


def main(folder: Path, each: int, conditions: list[str]) -> None:
    """Fit so many campaigns of each condition, and print the coverage.

    Without `conditions` it is that of all.
    """
    truths = [json.loads(path.read_text()) for path in sorted((folder / "truth").glob("*.json"))]
    names = [path.stem for path in sorted((folder / "truth").glob("*.json"))]
    chosen: dict[str, list[tuple[str, dict]]] = defaultdict(list)
    for name, truth in zip(names, truths, strict=True):
        faults = truth["case"]["nuisances"]
        if truth["case"]["effects"] or truth["case"]["trials"] < LEAST_TRIALS:
            continue
        condition = faults[0] if len(faults) == 1 else "several"
        wanted = condition in conditions or not conditions
        if wanted and len(chosen[condition]) < each:
            chosen[condition].append((name, truth))
    every = []
    for condition, cases in sorted(chosen.items()):
        held = [judge(folder / "campaign" / name, truth) for name, truth in cases]
        every += held
        tell(condition, held)
    tell("all", every)


def tell(condition: str, held: list[np.ndarray]) -> None:
    """Print a condition's shares."""
    found = np.concatenate(held, axis=-1)  # (fit and textbook, μ and σ, …)
    mean, spread, ideal = found[0, 0].mean(), found[0, 1].mean(), found[1].mean()
    print(
        f"{condition:20s} campaigns {len(held):3d}, intervals {found[0].size:4d}: μ {mean:.3f}, "
        f"σ {spread:.3f}, both {found[0].mean():.3f}; textbook {ideal:.3f}",
        flush=True,
    )


def judge(campaign: Path, truth: dict) -> np.ndarray:
    """Whether each 90 % interval contains the truth.

    The result is (fit and textbook, μ and σ, number).
    """
    config = read_config()
    with tempfile.TemporaryDirectory() as place:
        out = Path(place)
        fit(
            angles=prepare_angles(campaign, out, config),
            posterior=out / "posterior.nc",
            config=choose_settings(config, "fit"),
            cores=config["estimation"]["cores"],
            seed=1,
        )
        draws = open_tree(out / "posterior.nc", posterior_spec.SPEC)["posterior"].dataset.load()
    true = [np.array(truth["population"][name]) for name in ("mean", "sd")]
    held = []
    for statistic, value in zip(("mu", "sigma"), true, strict=True):
        columns = [draws[f"{statistic}_{parameter}"] for parameter in PARAMETERS]
        low, high = (
            np.stack([c.quantile(q, ("chain", "draw")).to_numpy() for c in columns])
            for q in (0.05, 0.95)
        )
        held.append(((low <= value) & (value <= high)).ravel())
    return np.array([held, judge_textbook(np.array(truth["individuals"]), *true)])


def judge_textbook(own: np.ndarray, mean: np.ndarray, sd: np.ndarray) -> np.ndarray:
    """Whether the textbook intervals contain the truth."""
    n, spread = len(own), own.std(axis=0, ddof=1)
    rank = [
        t.cdf((mean - own.mean(axis=0)) / spread * np.sqrt(n), n - 1),
        chi2.cdf((n - 1) * (spread / sd) ** 2, n - 1),
    ]
    return (np.abs(np.array(rank) - 0.5) <= 0.45).reshape(2, -1)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
