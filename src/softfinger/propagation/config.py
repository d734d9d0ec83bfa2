"""The settings of bands, densities and indices."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from softfinger.settings import Settings, read_settings

Positive = Annotated[float, Field(gt=0)]
Time = Annotated[float, Field(ge=0)]


class SpreadConfig(Settings):
    """What all of it depends on.

    `draws` of the posterior at most carry the bounds. Where the model has no closed form, at most
    `sampled_draws` of those draws count, with `draw_samples` new trials each (best a power of two).
    `c_p_truncation_sd` cuts the log-normal population of c_p at that many log-sd on either side;
    None keeps it whole, and with a heavy tail the mean and the sd of the angle are then what they
    are.
    """

    draws: Annotated[int, Field(ge=1)]
    sampled_draws: Annotated[int, Field(ge=1)]
    draw_samples: Annotated[int, Field(ge=64)]
    c_p_truncation_sd: Positive | None


class PropagateConfig(SpreadConfig):
    """What bands and densities depend on.

    `band_samples` new trials make the quantiles of the bands, on at most `band_times` times.
    """

    band_samples: Annotated[int, Field(ge=64)]
    band_times: Annotated[int, Field(ge=2)]
    density_times_s: Annotated[list[Time], Field(min_length=1)]
    density_angles: Annotated[int, Field(ge=2)]


class ShapleyConfig(SpreadConfig):
    """What Shapley effects depend on."""

    sobol_time_step_s: Positive


class SobolConfig(ShapleyConfig):
    """What Sobol indices depend on."""

    running_times_s: Annotated[list[Positive], Field(min_length=1)]


class PropagationConfig(PropagateConfig, SobolConfig):
    """Every setting of the propagation."""


def read_config[Part: SpreadConfig](
    config: Mapping[str, Any], part: type[Part] = PropagationConfig
) -> Part:
    """Validate the propagation's block, or a part.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.
    """
    return read_settings(part, config, "propagation", PropagationConfig)
