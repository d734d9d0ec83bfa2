"""The verdict of a diagnosis: content, checks, file.

The keys and their meaning are a format that others read (`verdict.json`, version 1). Keys without
a unit suffix are dimensionless or nats.
"""

import json
import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from softfinger.faults import ArtifactFault

Probability = Annotated[float, Field(ge=0.0, le=1.0)]
Decision = Literal["adequate", "named", "ambiguous", "unlisted"]
Level = Literal["within_trial", "between_trials", "measurement"]


class _VerdictPart(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Estimate(_VerdictPart):
    """One parameter of an effect.

    Mean, sd, and the interval that contains 90 %.
    """

    mean: float
    sd: Annotated[float, Field(ge=0.0)]
    q05: float
    q95: float


class Location(_VerdictPart):
    """Where an effect acts.

    Joints (p-value each), times since the last change, trials, covariate.
    """

    level: Level
    joints: dict[str, Probability]
    times_s: tuple[float, float] | None
    trials: list[str] | None
    covariate: str | None


class StatedLaw(_VerdictPart):
    """A free law.

    Where its curve is, and each textbook form's evidence against it [nats].
    """

    argument: str
    form: str
    range: tuple[float, float]
    artifact: str
    forms_nats: dict[str, float]


class StatedEffect(_VerdictPart):
    """One piece of physics that was left out.

    `spread`: parameter → sd between trials, as a share of its value; those that differ.
    """

    id: str
    joints: list[int]
    probability: Probability
    parameters: dict[str, Estimate]
    spread: dict[str, float] = {}
    law: StatedLaw | None = None
    statement: str
    location: Location | None


class Elpd(_VerdictPart):
    """Leave-one-trial-out log predictive density [nats].

    The trial's own parameters are integrated.
    """

    baseline: float
    final: float
    difference: float
    se: float


class ResidualRms(_VerdictPart):
    """Residuals of the base and the final model.

    At each trial's posterior mode; the noise is given too.
    """

    baseline: float
    final: float
    noise: float


class FreeFormNote(_VerdictPart):
    """The free-form term for what no listed effect explains."""

    argument: str
    joints: list[int]
    artifact: str


class SetAside(_VerdictPart):
    """A trial that was not used, and why."""

    trial: str
    reason: str


class Suffering(_VerdictPart):
    """What the recordings themselves suffer from.

    It never changes the decision.
    """

    id: str
    joints: list[int]
    trials: list[str]
    size: dict[str, float]
    evidence: float
    statement: str


class Remaining(_VerdictPart):
    """What is left under the final model.

    It is compared with what its measurement allows.
    """

    rms_over_noise: float
    p_value: Probability
    where: str


class Explained(_VerdictPart):
    """What one set of listed effects explains.

    Its gain over the base model, and the share of that in the evidence that is missing; whether
    no amplitude of it is clearly off zero; which of its effects would have to fall and rise again.
    """

    effects: list[str]
    gain_nats: float
    share: Probability
    amplitudes_cover_zero: bool
    turned_back: list[str] = []


class NotTried(_VerdictPart):
    """An effect that the campaign cannot show."""

    id: str
    reason: str


class Warned(_VerdictPart):
    """What looked wrong in the recordings.

    Trials are empty where it concerns all.
    """

    id: str
    trials: list[str]
    statement: str


class Verdict(_VerdictPart):
    """Result of a diagnosis."""

    version: Literal[1] = 1
    campaign: str
    decision: Decision
    effects: list[StatedEffect]
    equivalent: list[list[str]]
    location: Location | None
    elpd: Elpd | None
    residual_rms_rad: ResidualRms
    explained_spread: dict[str, dict[str, float]]
    not_testable: list[str]
    free_form: FreeFormNote | None
    n_trials: int
    set_aside: list[SetAside]
    next_experiment: dict[str, Any] | None
    measurement: list[Suffering] = []
    explained: list[Explained] = []
    remaining: Remaining | None = None
    not_tried: list[NotTried] = []
    warnings: list[Warned] = []

    @model_validator(mode="after")
    def _agree(self) -> Self:
        if self.decision == "adequate" and (self.effects or self.location):
            raise ValueError("an adequate model leaves out nothing: effects and location are empty")
        if self.decision == "named" and not self.effects:
            raise ValueError("a named verdict contains at least one effect")
        if self.decision == "ambiguous" and not self.equivalent:
            raise ValueError("an ambiguous verdict contains the set that cannot be told apart")
        return self


def write_verdict(verdict: Verdict, path: Path) -> None:
    """Write a verdict as JSON, keys as declared.

    They are in the order of their declaration.
    """
    text = json.dumps(verdict.model_dump(mode="json"), indent=2, ensure_ascii=False)
    Path(path).write_text(text + "\n", encoding="utf-8")


def read_verdict(path: Path) -> Verdict:
    """Read a verdict.

    `ArtifactFault` lists everything that is wrong with the file.
    """
    try:
        return Verdict.model_validate_json(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ArtifactFault(str(path), [str(error)]) from None
    except ValidationError as error:
        faults = [
            f"{'.'.join(map(str, fault['loc'])) or 'top level'}: {fault['msg']}"
            for fault in error.errors()
        ]
        raise ArtifactFault(str(path), faults) from None


def estimate_normal(mean: float, sd: float) -> Estimate:
    """Describe a normal posterior.

    >>> estimate_normal(5.9, 0.4).q95
    6.55794
    """
    reach = 1.64485 * sd
    return Estimate(mean=mean, sd=sd, q05=mean - reach, q95=mean + reach)


def estimate_lognormal(log_mean: float, log_sd: float) -> Estimate:
    """Describe a positive parameter whose logarithm is normal.

    >>> estimate_lognormal(0.0, 0.1).mean.__round__(6)
    1.005013
    """
    mean = math.exp(log_mean + 0.5 * log_sd**2)
    reach = 1.64485 * log_sd
    return Estimate(
        mean=mean,
        sd=mean * math.sqrt(math.expm1(log_sd**2)),
        q05=math.exp(log_mean - reach),
        q95=math.exp(log_mean + reach),
    )
