"""The `mismatch` block of the configuration."""

from typing import Annotated

from pydantic import Field

from softfinger.settings import Settings


class MismatchSettings(Settings):
    """Guards against chance; whether to sample the repair."""

    bootstrap_replicates: Annotated[int, Field(ge=99, le=9999)]
    false_alarm_probability: Annotated[float, Field(gt=0.0, le=0.1)]
    sample_repaired: bool
    longest_search_s: Annotated[float, Field(gt=0.0)]
