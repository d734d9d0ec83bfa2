"""Makes one concealed campaign, and beside it the truth."""

import json
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from softfinger.concealed.effects import CATALOGUES, Dose
from softfinger.concealed.faults import weigh_faults
from softfinger.concealed.noise import Noise
from softfinger.concealed.nuisances import NUISANCES, OF_NOISE
from softfinger.concealed.oracle import Fit, Recording, fit_model
from softfinger.concealed.population import PARAMETERS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import (
    Setting,
    choose_trials,
    draw_setting,
    record_cleanly,
    set_strengths,
)
from softfinger.concealed.spoil import Sight, recall, spoil
from softfinger.concealed.strength import place_strengths
from softfinger.concealed.suite import CaseSpec
from softfinger.concealed.writer import Film, write_campaign


def generate_campaign(
    spec: CaseSpec, folder: Path, truth_path: Path, film: Film | None = None
) -> dict:
    """Write a campaign folder, and its truth beside it.

    Parameters
    ----------
    spec : CaseSpec
    folder : Path
        Must not exist yet; its name should give nothing away.
    truth_path : Path
        A JSON file outside the folder.
    film : callable, optional
        Makes the videos of a filmed case: (angle (frame, joint) [rad], rig, path, seed).

    Raises
    ------
    ValueError
        The truth would lie inside the folder, or a filmed case comes without a film maker.
    """
    folder, truth_path = Path(folder), Path(truth_path)
    if folder.resolve() in truth_path.resolve().parents:
        raise ValueError(
            f"{truth_path}: the truth would be inside the campaign; put it beside the campaign"
        )
    written = write_recordings(spec, folder, film)
    # of a film the oracle is given noisy angles in place of the tracked ones
    truth = compute_truth(spec, written.setting, written.doses, written.clean, written.sights)
    truth["aimed_at_nats"] = written.aims
    truth_path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(truth, indent=1, sort_keys=True)
    truth_path.write_text(text + "\n", encoding="utf-8")
    return json.loads(text)


class Written(NamedTuple):
    """What was concealed in a campaign folder, before any oracle sees it."""

    setting: Setting
    doses: dict[str, Dose]
    clean: list[Recording]
    sights: list[Sight]
    aims: dict[str, float]


def write_recordings(spec: CaseSpec, folder: Path, film: Film | None = None) -> Written:
    """Write a campaign folder alone.

    Parameters and errors as of `generate_campaign`.
    """
    if spec.filmed and film is None:
        raise ValueError(f"{folder}: this case is filmed; pass the function that films a trial")
    setting = draw_setting(spec)
    # a nuisance leaves the strength as it is without it
    strengths, aims = _place_strengths(spec, draw_setting(replace(spec, nuisances=())))
    doses = set_strengths(setting.doses, strengths)
    clean = record_cleanly(setting, doses, np.arange(spec.trials))
    sights = spoil(setting, doses, clean, spec.seed)
    rng = np.random.default_rng([spec.seed, 2])
    write_campaign(
        folder,
        setting,
        clean if spec.filmed else [sight.recording for sight in sights],
        [sight.rows for sight in sights],
        declares_noise=bool(rng.uniform() < 0.5),
        film=film if spec.filmed else None,
        seed=int(rng.integers(2**31)),
    )
    return Written(setting, doses, clean, sights, aims)


def _place_strengths(spec: CaseSpec, setting: Setting) -> tuple[dict[str, float], dict[str, float]]:
    """Strengths, and target gains [nats] where drawn."""
    if spec.strengths:
        return dict(zip(spec.effects, spec.strengths, strict=True)), {}
    places = dict(zip(spec.effects, spec.quantiles, strict=True))
    return place_strengths(places, setting, even=spec.even)


def compute_truth(
    spec: CaseSpec,
    setting: Setting,
    doses: dict[str, Dose],
    clean: list[Recording],
    sights: list[Sight],
) -> dict:
    """All that was concealed, as the oracle sees it.

    For every effect the gain with it over without it, the other effects being known; for the
    whole set the gain over the base model. The window is where, in seconds since the last change
    of load, the middle four fifths of what the base model cannot fit lie.
    """
    seen = recall(setting, sights, spec.seed)
    fits: dict[tuple[str, ...], Fit] = {}

    def fit(names: tuple[str, ...]) -> Fit:
        if names not in fits:
            kept = {name: doses[name] for name in names}
            fits[names] = fit_model(seen, setting.rig, setting.noise, kept, setting.individuals)
        return fits[names]

    names = tuple(doses)
    base, true = fit(()), fit(names)
    gains = {
        name: true.log_evidence - fit(tuple(o for o in names if o != name)).log_evidence
        for name in names
    }
    elpd = true.solution.contributions - base.solution.contributions
    told = [
        _describe(name, doses[name], setting, gains[name])
        | {"listed": EFFECTS[name].id in CATALOGUES[spec.catalogue]}
        for name in names
    ]
    return {
        "version": 1,
        "case": spec.to_json(),
        "effects": told,
        "gain_nats": true.log_evidence - base.log_evidence,
        "elpd_difference": float(elpd.sum()) if spec.trials > 1 else None,
        "values": int(sum(recording.angle.size for recording in seen)),
        "misfit": {"base": _misfit(base), "true": _misfit(true)},
        "oracle_settled": all(f.settled for f in fits.values()),
        "window_s": _find_window(setting, clean) if doses else None,
        "noise": _describe_noise(setting.noise),
        "faults": _describe_faults(setting, weigh_faults(setting, sights, doses, spec.seed)),
        "population": {
            "parameter": list(PARAMETERS),
            "mean": setting.population.mean.tolist(),
            "sd": setting.population.sd.tolist(),
        },
        "individuals": setting.individuals.tolist(),
    }


def _describe_noise(noise: Noise) -> dict:
    return {
        "kind": noise.kind,
        "sd_rad": noise.sd,
        "autocorrelation": noise.autocorrelation,
        "findings": list(OF_NOISE.get(noise.kind, ())),
    }


def _describe(name: str, dose: Dose, setting: Setting, gain: float) -> dict:
    effect = EFFECTS[name]
    return {
        "id": effect.id,
        "name": name,
        "law": effect.law,
        "scatter": dose.scatter,
        "argument": effect.argument,
        "level": effect.level,
        "covariate": effect.covariate,
        "joints": [j + 1 for j in dose.joints],
        "strength": dose.strength,
        "shape": dose.shape,
        "parameters": effect.tell(dose, setting.trials),
        "gain_nats": gain,
    }


def _describe_faults(setting: Setting, nats: dict[str, float]) -> list[dict]:
    return [
        {
            "id": name,
            "finding": NUISANCES[name].finding,
            "also": list(NUISANCES[name].also),
            "size": fault.size,
            "shape": fault.shape,
            "nats": nats.get(name),
        }
        for name, fault in setting.faults.items()
    ]


def _misfit(fit: Fit) -> float:
    """Mean square of the whitened residual; noise: 1."""
    return float(np.mean(np.concatenate([r.ravel() for r in fit.residuals]) ** 2))


def _find_window(setting: Setting, clean: list[Recording]) -> list[float]:
    chosen = choose_trials(len(clean), 6)
    fit = fit_model(
        [clean[k] for k in chosen],
        setting.rig,
        setting.noise,
        {},
        setting.individuals[chosen],
    )
    since, energy = [], []
    for k, residual in zip(chosen, fit.residuals, strict=True):
        change = np.unique(clean[k].trial.load.time)
        last = np.searchsorted(change, clean[k].time, side="right") - 1
        loaded = last >= 0
        since.append((clean[k].time - change[np.clip(last, 0, None)])[loaded])
        energy.append((residual**2).sum(axis=1)[loaded])
    order = np.argsort(np.concatenate(since))
    share = np.cumsum(np.concatenate(energy)[order])
    ends = np.searchsorted(share, [0.1 * share[-1], 0.9 * share[-1]])
    return [round(float(t), 3) for t in np.concatenate(since)[order][ends]]
