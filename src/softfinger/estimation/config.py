"""The settings of the fits and sampling limits."""

from typing import Annotated, Literal

from pydantic import Field

from softfinger.settings import Settings

Positive = Annotated[float, Field(gt=0)]
Count = Annotated[int, Field(ge=1)]


class EstimationConfig(Settings):
    """The outlier rule, the sampler's size and limits."""

    outlier_rule: Literal["scaled_mad", "raw_mad"]
    outlier_cutoff: Positive
    sampler: Literal["nuts", "gibbs"]
    chains: Annotated[int, Field(ge=2)]
    tune: Count
    draws: Count
    covariance: Literal["independent", "joint", "full"]
    cores: Count
    target_accept: Annotated[float, Field(gt=0, lt=1)]
    max_depth: Count
    predictive_draws: Count
    r_hat_max: Annotated[float, Field(gt=1)]
    ess_min: Positive
    divergences_max: Annotated[int, Field(ge=0)]
