"""Models that recordings leave open, with their posterior.

A survivor is a model with its fit; its coordinates are θ = (μ, φ), population means and effects.
"""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError
from ruamel.yaml import YAML

from softfinger.artifacts import write_atomically
from softfinger.faults import Fault, ListedFault, show
from softfinger.gate import read_document
from softfinger.inference.mixed_effects import hold_omega
from softfinger.inference.mixed_effects_linearised import centre_gram
from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model import Piece
from softfinger.mechanics.effects.model_file import (
    FittedTo,
    ModelFile,
    build_model,
    describe_model,
)
from softfinger.mechanics.effects.prior_file import Part
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.settle import Posterior, join_ids


class Survivor(NamedTuple):
    """A model that is left, fitted.

    Attributes
    ----------
    label
        Its effects joined by +; `none` is the base model.
    candidate
        Model and fit.
    covariance
        (d + p, d + p) of θ.
    probability
        Posterior, before the next recordings.
    """

    label: str
    candidate: Candidate
    covariance: NDArray[np.float64]
    probability: float


class OpenModel(Part):
    """One survivor in a file."""

    effects: str
    probability: Annotated[float, Field(ge=0.0, le=1.0)]
    model: ModelFile


class OpenModels(Part):
    """The file `survivors.yaml`.

    `hidden` has ids of effects that the recordings could not show, `measurement` what the
    recordings suffer from.
    """

    version: Literal[1]
    fitted_to: FittedTo
    decision: str
    survivors: Annotated[list[OpenModel], Field(min_length=1)]
    hidden: list[str] = Field(default_factory=list)
    measurement: MeasurementEntry | None = None


def list_survivors(problem: Problem, posterior: Posterior) -> list[Survivor]:
    """List the models that together are sure.

    Models that were not fitted to rest are left out; probabilities of the others sum to 1. Where
    none of these was, the most probable fitted model is left, or the base model.
    """
    chosen = [
        (join_ids(ids), posterior.best[ids], posterior.sets[ids])
        for ids in posterior.equivalent[: BUDGET.survivors]
    ]
    fitted = [entry for entry in chosen if entry[1].fit is not None]
    if not fitted:
        rest = (ids for ids in posterior.sets if posterior.best[ids].fit is not None)
        fitted = [(join_ids(ids), posterior.best[ids], 1.0) for ids in islice(rest, 1)]
    total = sum(probability for *_, probability in fitted)
    return [
        Survivor(label, candidate, measure_uncertainty(problem, candidate), probability / total)
        for label, candidate, probability in fitted
    ]


def measure_uncertainty(problem: Problem, candidate: Candidate) -> NDArray[np.float64]:
    """Laplace covariance (d + p, d + p) of θ."""
    fit, prior = candidate.fit, problem.build_prior(candidate.model)
    moved, near, _ = centre_gram(fit.gram, prior, fit.own, fit.shared)
    return hold_omega(moved, near, fit.omega).shared_covariance


def suppose_effects(
    problem: Problem, base: Survivor, pieces: Sequence[Piece], wanted: Sequence[str]
) -> list[Survivor]:
    """Suppose effects that recordings could not show.

    Each is in its first form at every joint, with amplitudes of `DECISIONS.strength` prior sds;
    the trials' own parameters stay those of the base model. Half of the probability is the base's.

    Returns
    -------
    list
        The base model first.
    """
    first: dict[str, Piece] = {}
    for piece in pieces:
        if piece.effect.id in wanted:
            first.setdefault(piece.effect.id, piece)
    kept = list(first.items())[: BUDGET.survivors - 1]
    supposed = [_suppose(problem, base, name, piece, 0.5 / len(kept)) for name, piece in kept]
    return [base._replace(probability=0.5 if kept else 1.0), *supposed]


def _suppose(
    problem: Problem, base: Survivor, name: str, piece: Piece, probability: float
) -> Survivor:
    known = base.candidate
    model = known.model.extend(piece)
    new = np.arange(len(known.fit.shared), len(model.entries))
    start = model.place_start(len(model.pieces) - 1, model.list_starts(len(model.pieces) - 1)[0])
    sd = model.shared_prior[1][new]
    strong = np.where(model.amplitudes[new], DECISIONS.strength * sd, start)
    shared = np.concatenate([known.fit.shared, np.clip(strong, model.low[new], model.high[new])])
    first, d = len(known.fit.mean), len(base.covariance)
    size = d + len(new)
    covariance = np.zeros((size, size))
    covariance[:d, :d] = base.covariance
    covariance[np.arange(d, size), np.arange(d, size)] = sd**2
    fit = known.fit._replace(shared=shared, shared_covariance=covariance[first:, first:])
    return Survivor(name, Candidate(model, fit, 0.0), covariance, probability)


def describe_survivors(
    survivors: Sequence[Survivor],
    fitted_to: FittedTo,
    decision: str,
    hidden: Sequence[str],
    measurement: MeasurementEntry | None = None,
) -> OpenModels:
    """Describe the survivors, as a file."""
    listed = []
    for survivor in survivors:
        fit = survivor.candidate.fit
        model = survivor.candidate.model
        covariance = survivor.covariance[len(fit.mean) :, len(fit.mean) :]
        described = describe_model(model, fit.shared, covariance, fitted_to)
        listed.append(
            OpenModel(
                effects=survivor.label,
                probability=round(survivor.probability, 6),
                model=described,
            )
        )
    return OpenModels(
        version=1,
        fitted_to=fitted_to,
        decision=decision,
        survivors=listed,
        hidden=list(hidden),
        measurement=measurement,
    )


def write_survivors(content: OpenModels, path: Path) -> None:
    """Write the survivors' file."""
    yaml = YAML()
    yaml.width = 200
    with write_atomically(path) as temporary, temporary.open("w", encoding="utf-8") as stream:
        yaml.dump(content.model_dump(mode="json"), stream)


def read_survivors(path: Path, sha256: str) -> OpenModels:
    """Read the survivors of these recordings.

    Raises
    ------
    ListedFault
        The file is no such file; all faults are listed.
    Fault
        It is missing, or of other recordings than those of this hash.
    """
    try:
        content = OpenModels.model_validate(read_document(Path(path)).content)
    except ValidationError as error:
        faults = [f"{'.'.join(map(str, f['loc']))}: {f['msg']}" for f in error.errors()]
        raise ListedFault(str(path), faults) from None
    if content.fitted_to.sha256 != sha256:
        raise Fault(
            f"{path}: it was made from other recordings (campaign "
            f"{show(content.fitted_to.campaign)}) than the angles.nc beside it; diagnose the "
            "campaign again"
        )
    return content


def refit_survivors(problem: Problem, base: Candidate, content: OpenModels) -> list[Survivor]:
    """Fit the survivors of a file again.

    Raises
    ------
    Fault
        None of them can be fitted to these recordings.
    """
    found = []
    for listed in content.survivors:
        candidate = _refit(problem, base, listed.model)
        if candidate is not None:
            covariance = measure_uncertainty(problem, candidate)
            found.append(Survivor(listed.effects, candidate, covariance, listed.probability))
    if not found:
        raise Fault("no model of survivors.yaml can be fitted again; diagnose the campaign again")
    total = sum(s.probability for s in found)
    return [s._replace(probability=s.probability / total) for s in found]


def _refit(problem: Problem, base: Candidate, content: ModelFile) -> Candidate | None:
    if not content.effects:
        return base
    known = build_model(content, problem.setting)
    model = build_model(content, problem.setting, priors=False)
    start = np.clip(known.shared_prior[0], model.low, model.high)
    fit = problem.fit(model, (base.fit.own, start, base.fit.omega))
    return None if fit is None else Candidate(model, fit, fit.log_evidence)
