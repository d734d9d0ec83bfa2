"""The limits that the report holds its checks against."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from softfinger.settings import Settings, read_settings

Probability = Annotated[float, Field(gt=0, lt=1)]
Positive = Annotated[float, Field(gt=0)]


class ReportConfig(Settings):
    """Every limit of the report; what exceeds one turns its verdict red."""

    ci_prob: Probability
    r_hat_max: Annotated[float, Field(gt=1)]
    ess_min: Positive
    divergences_max: Annotated[int, Field(ge=0)]
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
    return read_settings(ReportConfig, config.get("report", {}), "report")
