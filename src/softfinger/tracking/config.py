"""The settings of tracking, units in their names."""

from typing import Annotated

from pydantic import Field

from softfinger.settings import Settings

Positive = Annotated[float, Field(gt=0)]


class TrackingConfig(Settings):
    """What tracking must reach to use a trial."""

    smallest_share_seen: Annotated[float, Field(ge=0, le=1)]
    largest_rigid_residual_px: Positive
    largest_sd_px: Positive
