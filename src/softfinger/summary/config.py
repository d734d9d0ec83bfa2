"""The limits of the report's checks."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from softfinger.settings import Settings, read_settings

Probability = Annotated[float, Field(gt=0, lt=1)]
Positive = Annotated[float, Field(gt=0)]


class ReportConfig(Settings):
    """The report's limits; beyond one, red."""

    ci_prob: Probability
    pareto_k_max: Positive
    shared_residual_max: Positive
    coverage_tolerance: Probability


def read_config(config: Mapping[str, Any]) -> ReportConfig:
    """Validate the `report` block of the configuration.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.
    """
    return read_settings(ReportConfig, config, "report")
