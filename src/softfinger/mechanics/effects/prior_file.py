"""Priors of a model file, and what is wrong with it."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from softfinger.faults import show

Positive = Annotated[float, Field(gt=0.0)]


class Part(BaseModel):
    """A part of a model file; nothing else is in it."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


class NormalPrior(Part):
    """A parameter that is normal, in its own unit."""

    mean: float
    sd: Positive


class LogNormalPrior(Part):
    """A positive parameter whose natural logarithm is normal."""

    median: Positive
    log_sd: Positive


def _choose_prior(content: object) -> str:
    """Which prior is meant, by its keys."""
    positive = isinstance(content, LogNormalPrior) or (
        isinstance(content, Mapping) and not {"median", "log_sd"}.isdisjoint(content)
    )
    return LogNormalPrior.__name__ if positive else NormalPrior.__name__


Prior = Annotated[
    Annotated[NormalPrior, Tag(NormalPrior.__name__)]
    | Annotated[LogNormalPrior, Tag(LogNormalPrior.__name__)],
    Discriminator(_choose_prior),
]


def describe_fault(fault: Mapping[str, Any]) -> str:
    """Key and fault, of what pydantic found."""
    tags = (NormalPrior.__name__, LogNormalPrior.__name__)
    key = ".".join(str(part) for part in fault["loc"] if part not in tags) or "top level"
    said = fault["msg"].removeprefix("Value error, ")
    kinds = {
        "model_type": "expected keys, as in {mean: 0.0, sd: 1.0} or {median: 1.0, log_sd: 0.5}",
        "missing": "this key is missing; give it a value",
        "extra_forbidden": "this key is unknown; remove it, or see the documentation's spelling",
    }
    other = f"is {show(str(fault['input']))}; {said[:1].lower()}{said[1:]}"
    return f"{key}: {kinds.get(fault['type'], other)}"
