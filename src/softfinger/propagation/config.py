"""The knobs of bands, densities and indices, each with its unit in its name."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from softfinger.faults import ListedFault

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class PropagationConfig(BaseModel):
    """Every knob of the propagation; an unknown or missing key is a fault.

    `c_p_truncation_sd` cuts the log-normal population of c_p at that many log-sd on either side;
    None keeps it whole, and with a heavy tail the mean and sd of the angle are then what they are.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    draws: Annotated[int, Field(ge=1)]
    band_samples: Annotated[int, Field(ge=64)]
    band_times: Annotated[int, Field(ge=2)]
    sobol_time_step_s: Positive
    running_times_s: Annotated[list[Positive], Field(min_length=1)]
    density_times_s: Annotated[list[Time], Field(min_length=1)]
    density_angles: Annotated[int, Field(ge=2)]
    c_p_truncation_sd: Positive | None


def read_config(config: dict) -> PropagationConfig:
    """Validate the propagation's block of the configuration.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.
    """
    try:
        return PropagationConfig.model_validate(config)
    except ValidationError as error:
        faults = [
            f"{'.'.join(map(str, fault['loc']))}: {fault['msg']}"
            + (f", got {fault['input']!r}" if fault["type"] != "missing" else "")
            for fault in error.errors()
        ]
        raise ListedFault("the propagation's configuration", faults) from None
