"""Blocks of the configuration, with units and ranges."""

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from softfinger.faults import ListedFault


class Settings(BaseModel):
    """Base of every block of the configuration.

    It has no defaults, so that ``config/default.yaml`` shows every value.

    An unknown or missing key is a fault.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def read_settings[Block: Settings](
    block: type[Block], values: Mapping[str, Any], name: str, whole: type[Settings] | None = None
) -> Block:
    """Validate one block, or the part a stage reads.

    Parameters
    ----------
    values
        Key → value, as read from YAML.
    name
        What it is called in the message.
    whole
        Of a part, the declaration of the whole block: its other keys may be there or not.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.

    Examples
    --------
    >>> class Camera(Settings):
    ...     fps: float
    >>> read_settings(Camera, {"fsp": 30.0}, "camera")
    Traceback (most recent call last):
      ...
    softfinger.faults.ListedFault: the configuration's camera cannot be used (2 faults):
      - fps: field required
      - fsp: extra inputs are not permitted, got 30.0
    """
    others = set() if whole is None else set(whole.model_fields) - set(block.model_fields)
    try:
        return block.model_validate({k: value for k, value in values.items() if k not in others})
    except ValidationError as error:
        faults = [_describe(fault) for fault in error.errors()]
        raise ListedFault(f"the configuration's {name}", faults) from None


def _describe(fault: Any) -> str:  # noqa: ANN401 (pydantic's error record)
    key = ".".join(str(part) for part in fault["loc"])
    message = fault["msg"].removeprefix("Value error, ")
    message = message[:1].lower() + message[1:]
    got = "" if fault["type"] == "missing" or not key else f", got {fault['input']!r}"
    return f"{key}: {message}{got}" if key else f"{message}{got}"
