"""The model file `model.yaml`.

It states which physics a stage uses, in place of the base model.

`priors` states what is known of an effect's parameters: `{median, log_sd}` of one that is positive
and spans decades, `{mean, sd}` of any other; those that are absent have the catalogue's priors.
Where a model was fitted, they are its posterior; a fit to the very same recordings, which
`fitted_to` names by the hash of their `angles` artifact, leaves them out, lest data count twice.

`measurement` states what these recordings suffer from; every step that reads the file sets the
same recordings right by it, and leaves other ones as they are.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationError
from ruamel.yaml import YAML

from softfinger.faults import Fault, ListedFault, show
from softfinger.gate import read_document
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.law_file import LawEntry, describe_laws, read_laws
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model import EffectModel, Entry, Known, Piece
from softfinger.mechanics.effects.places import describe_places
from softfinger.mechanics.effects.prior_file import (
    LogNormalPrior,
    NormalPrior,
    Part,
    Positive,
    Prior,
    describe_fault,
)
from softfinger.mechanics.effects.spread import doubt_spreads, name_spreads, take_spreads

DIGITS = 7
UNUSED = {"law": None, "law_size": 1.0, "spreads": {}}  # not written
Joint = Annotated[int, Field(ge=1)]


class EffectEntry(Part):
    """One effect in one form.

    A form of pairs of joints names them as [[2, 1]]: 2 moved by 1.

    A free form has its `law`: one curve, or one for each of its joints, `law_size` of the usual.
    `spreads`: by how much parameters differ between trials, as shares.
    """

    id: str
    form: str
    joints: list[Joint | tuple[Joint, Joint]] = Field(default_factory=list)
    law: LawEntry | list[LawEntry] | None = None
    law_size: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    priors: dict[str, Prior] = Field(default_factory=dict)
    spreads: dict[str, Positive] = Field(default_factory=dict)


class FittedTo(Part):
    """The recordings that a model was fitted to."""

    campaign: str
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class ModelFile(Part):
    """The content of a model file, and where it was read."""

    version: Literal[1]
    joint: Literal["three_element"]
    torque: Literal["constant_arm"]
    effects: list[EffectEntry]
    fitted_to: FittedTo | None = None
    measurement: MeasurementEntry | None = None
    _place: str = PrivateAttr("the model")
    _lines: dict[int, int] = PrivateAttr(default_factory=dict)

    @property
    def place(self) -> str:
        """The file, for messages."""
        return self._place

    @property
    def spreads(self) -> dict[str, float]:
        """Spread's name → relative sd between trials."""
        return name_spreads({entry.id: entry.spreads for entry in self.effects})

    def was_fitted_to(self, sha256: str) -> bool:
        """Whether priors come from `angles` of this hash."""
        return self.fitted_to is not None and self.fitted_to.sha256 == sha256

    def describe_origin(self, sha256: str) -> str | None:
        """What to know of a model from other recordings."""
        if self.fitted_to is None or self.was_fitted_to(sha256):
            return None
        return (
            f"{self.place}: it was fitted to other recordings (campaign "
            f"{show(self.fitted_to.campaign)}), and its priors count as knowledge from there; "
            "remove `priors` and `fitted_to` to have everything estimated from these"
        )

    def name_effect(self, number: int) -> str:
        """An effect's place, for messages; counted from 1."""
        where = f"line {self._lines[number]}, " if number in self._lines else ""
        return f"{where}effect {number} ({self.effects[number - 1].id})"


def read_model_file(path: Path | str) -> ModelFile:
    """Read a model file.

    Raises
    ------
    Fault
        The file is missing or no YAML.
    ListedFault
        A key is unknown, missing or of the wrong kind; all faults are listed.
    """
    document = read_document(Path(path))
    try:
        content = ModelFile.model_validate(document.content)
    except ValidationError as error:
        faults = [
            f"line {document.find_line(fault['loc'])}, {describe_fault(fault)}"
            for fault in error.errors()
        ]
        raise ListedFault(str(path), faults) from None
    numbers = range(1, len(content.effects) + 1)
    content._place = str(path)
    content._lines = {n: document.find_line(("effects", n - 1)) for n in numbers}
    return content


def write_model_file(content: ModelFile, path: Path | str) -> None:
    """Write a model file; read again, its bytes stay."""
    yaml = YAML()
    yaml.width = 200
    unused = {"measurement"} if content.measurement is None else None
    document = content.model_dump(mode="json", exclude=unused)
    document["effects"] = [
        {key: v for key, v in effect.items() if key not in UNUSED or v != UNUSED[key]}
        for effect in document["effects"]
    ]
    with Path(path).open("w", encoding="utf-8", newline="\n") as stream:
        yaml.dump(document, stream)


def build_model(content: ModelFile, setting: Setting, *, priors: bool = True) -> EffectModel:
    """Build the model of a file for a campaign.

    Parameters
    ----------
    priors
        Whether the file's priors replace those of the catalogue.

    Raises
    ------
    ListedFault
        An effect, form, joint or parameter that this campaign or program does not have.
    """
    faults: list[str] = []
    pieces, known = [], {}
    for number, entry in enumerate(content.effects, start=1):
        place = content.name_effect(number)
        piece = _build_piece(entry, setting, place, faults)
        if piece is None:
            continue
        if any(piece.effect.id == other.effect.id for other in pieces):
            faults.append(f"{place}: the effect appears twice; give it once, with all its joints")
        pieces.append(piece)
        alone = EffectModel(setting, (piece,))
        known |= _read_priors(entry, alone, place, faults)
        known |= read_laws(entry.law, alone, place, faults)
        faults += [f"{place}: {said}" for said in doubt_spreads(entry.spreads, piece, alone)]
    if faults:
        raise ListedFault(content.place, faults)
    return EffectModel(setting, tuple(pieces), known if priors else {})


def read_strength(model: EffectModel) -> NDArray[np.float64]:
    """Middle of φ's priors (p,), internal.

    Raises
    ------
    Fault
        An effect has no strength, because its amplitudes have no prior in the file.
    """
    middle, _ = model.shared_prior
    middle = np.clip(middle, model.low, model.high)
    for number, piece in enumerate(model.pieces):
        mine = [k for k, e in enumerate(model.entries)
                if e.piece == number and e.parameter.amplitude]  # fmt: skip
        if not np.any(middle[mine]):
            names = ", ".join(model.entries[k].name for k in mine)
            raise Fault(
                f"the model gives {piece.effect.id} no strength: add priors for {names} to the "
                "model file"
            )
    return middle


def describe_model(
    model: EffectModel,
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    fitted_to: FittedTo | None,
    spreads: Mapping[str, float] | None = None,
) -> ModelFile:
    """Describe a model, given φ's mean and covariance.

    Parameters
    ----------
    spreads
        Spread's name → relative sd between trials.
    """
    sd, effects = np.sqrt(np.diag(covariance)), []
    for number, piece in enumerate(model.pieces):
        priors = {
            entry.name: _describe_prior(entry, float(mean[k]), float(sd[k]))
            for k, entry in enumerate(model.entries)
            if entry.piece == number and not model.terms[k]
        }
        joints = [place[0] + 1 if len(place) == 1 else (place[0] + 1, place[1] + 1)
                  for place in piece.places]  # fmt: skip
        effects.append(
            EffectEntry(
                id=piece.effect.id,
                form=piece.form.name,
                joints=joints,
                law=describe_laws(model, number, mean, covariance),
                law_size=piece.size,
                priors=priors,
                spreads=take_spreads(piece, model, spreads or {}),
            )
        )
    return ModelFile(
        version=1,
        joint="three_element",
        torque="constant_arm",
        effects=effects,
        fitted_to=fitted_to,
    )


def _build_piece(
    entry: EffectEntry, setting: Setting, place: str, faults: list[str]
) -> Piece | None:
    effects = list_effects()
    if entry.id not in effects:
        faults.append(f"{place}: unknown effect; there are {', '.join(effects)}")
        return None
    forms = effects[entry.id].list_forms(setting)
    if isinstance(forms, str):
        faults.append(f"{place}: these recordings cannot have it: {forms}")
        return None
    known = [*forms, *(form.finer for form in forms if form.finer is not None)]
    form = next((form for form in known if form.name == entry.form), None)
    if form is None:
        names = ", ".join(form.name for form in known)
        faults.append(f"{place}: no form {entry.form!r} here; there are {names}")
        return None
    given = [joint if isinstance(joint, tuple) else (joint,) for joint in entry.joints]
    kinds = {parameter.per for parameter in form.parameters}
    words, right = describe_places(kinds, single=form.local)
    whole = all(max(g) <= setting.joints for g in given) and len(set(given)) == len(given)
    if not whole or not right(given):
        faults.append(f"{place}: joints are {entry.joints}; expected {words} of {setting.joints}")
        return None
    places = tuple(tuple(j - 1 for j in g) for g in given)
    return Piece(effects[entry.id], form, places, entry.law_size)


def _read_priors(entry: EffectEntry, model: EffectModel, place: str, faults: list[str]) -> Known:
    by_name: Mapping[str, Entry] = {e.name: e for e in model.entries}
    known = {}
    for name, prior in entry.priors.items():
        if name not in by_name:
            faults.append(f"{place}: no parameter {name!r}; there are {', '.join(by_name)}")
        elif by_name[name].parameter.log != isinstance(prior, LogNormalPrior):
            wanted = "median and log_sd" if by_name[name].parameter.log else "mean and sd"
            faults.append(f"{place}: the prior of {name} needs {wanted}")
        elif isinstance(prior, LogNormalPrior):
            known[entry.id, name] = (math.log(prior.median), prior.log_sd)
        else:
            known[entry.id, name] = (prior.mean, prior.sd)
    return known


def _describe_prior(entry: Entry, mean: float, sd: float) -> NormalPrior | LogNormalPrior:
    def short(value: float) -> float:
        return float(f"{value:.{DIGITS}g}")

    if entry.parameter.log:
        return LogNormalPrior(median=short(math.exp(mean)), log_sd=short(sd))
    return NormalPrior(mean=short(mean), sd=short(sd))
