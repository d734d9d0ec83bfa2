"""The knobs of bands, densities and indices, each with its unit in its name."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from softfinger.settings import Settings, read_settings

Positive = Annotated[float, Field(gt=0)]
Time = Annotated[float, Field(ge=0)]


class PropagationConfig(Settings):
    """Every knob of the propagation.

    `draws` of the posterior at most carry the bounds. `band_samples` new trials make the quantiles
    of the bands, on at most `band_times` times. `c_p_truncation_sd` cuts the log-normal population
    of c_p at that many log-sd on either side; None keeps it whole, and with a heavy tail the mean
    and the sd of the angle are then what they are.
    """

    draws: Annotated[int, Field(ge=1)]
    band_samples: Annotated[int, Field(ge=64)]
    band_times: Annotated[int, Field(ge=2)]
    sobol_time_step_s: Positive
    running_times_s: Annotated[list[Positive], Field(min_length=1)]
    density_times_s: Annotated[list[Time], Field(min_length=1)]
    density_angles: Annotated[int, Field(ge=2)]
    c_p_truncation_sd: Positive | None


def read_config(config: Mapping[str, Any]) -> PropagationConfig:
    """Validate the propagation's block of the configuration.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.
    """
    return read_settings(PropagationConfig, config, "propagation")
