"""The settings of the virtual rig."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from softfinger.settings import Settings, read_settings

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
N_JOINTS = 3  # the paper's table has three


class SceneConfig(Settings):
    """What the campaign and its pictures share."""

    fps: Positive
    link_length_m: Annotated[list[Positive], Field(min_length=N_JOINTS, max_length=N_JOINTS)]
    joint_length_m: Positive
    metres_per_pixel: Positive
    marker_diameter_m: Positive


class FilmConfig(SceneConfig):
    """What the pictures depend on."""

    marker_contrast_grey: Annotated[float, Field(gt=0, le=190)]
    blur_px: Annotated[float, Field(ge=0.3, le=5)]  # sharper discs would need finer area sampling
    light_unevenness: Annotated[float, Field(ge=0, lt=1)]
    camera_noise_grey: NotNegative
    video_quality: Annotated[int, Field(ge=1, le=100)]


class RigConfig(SceneConfig):
    """What the motion and the campaign's tables depend on."""

    n_trials: Annotated[int, Field(ge=1)]
    level: Literal["video", "angles"]
    duration_s: Positive
    load_time_s: Annotated[list[float], Field(min_length=1)]
    load_tension_n: Annotated[list[NotNegative], Field(min_length=1)]
    wire_geometry: Literal["constant_arm", "paper"]
    link_mass_kg: Annotated[list[Positive], Field(min_length=N_JOINTS, max_length=N_JOINTS)]
    wire_offset_m: Positive
    trial_interval_s: Positive
    angle_noise_sd_rad: NotNegative
    angle_noise_autocorrelation: Annotated[float, Field(gt=-1, lt=1)]

    @model_validator(mode="after")
    def _check_load(self) -> Self:
        if len(self.load_time_s) != len(self.load_tension_n):
            raise ValueError(
                f"load_time_s has {len(self.load_time_s)} values but load_tension_n "
                f"{len(self.load_tension_n)}; give one tension per time"
            )
        if sorted(self.load_time_s) != self.load_time_s:
            raise ValueError("load_time_s runs backwards; give times that never decrease")
        return self

    @property
    def n_frames(self) -> int:
        """Frames per trial, the first at time 0."""
        return max(1, round(self.duration_s * self.fps))


class VirtualRigConfig(RigConfig, FilmConfig):
    """Every setting of the virtual rig."""


def read_film_config(config: Mapping[str, Any]) -> FilmConfig:
    """Validate what pictures depend on, as `read_config` does."""
    return read_settings(FilmConfig, config, "virtual_rig", VirtualRigConfig)


def read_rig_config(config: Mapping[str, Any]) -> RigConfig:
    """Validate settings of motion and tables, as `read_config`."""
    return read_settings(RigConfig, config, "virtual_rig", VirtualRigConfig)


def read_config(config: Mapping[str, Any]) -> VirtualRigConfig:
    """Validate the virtual rig's block of the configuration.

    Raises
    ------
    ListedFault
        Lists every key that is unknown, missing or out of range.
    """
    return read_settings(VirtualRigConfig, config, "virtual_rig")
