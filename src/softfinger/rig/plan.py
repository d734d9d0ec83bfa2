"""The plan of a recording, one YAML file."""

from collections import Counter
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from softfinger.campaign.description import Description
from softfinger.faults import Fault, ListedFault
from softfinger.gate import read_document
from softfinger.rig.profiles import Count, NotNegative, Positive, Profile
from softfinger.settings import Settings, read_settings

Pixels = Annotated[int, Field(ge=0)]


class Safety(Settings):
    """Limits that both sides check; harmless silence."""

    tension_limit_n: Positive
    connect_timeout_s: Positive  # controllers that restart when their port is opened need seconds
    heartbeat_s: Positive  # the recorder's; the controller's watchdog must be three times as long
    answer_timeout_s: Positive
    stream_timeout_s: Positive
    camera_timeout_s: Positive
    dropped_frames_share: Annotated[float, Field(ge=0, lt=1)]  # of a trial; more and it is refused


class Recording(Settings):
    """How each trial is recorded."""

    stream_rate_hz: Annotated[int, Field(ge=1)]
    lead_in_s: Positive  # filmed at rest before the pull
    rest_s: NotNegative  # between trials, the wire slack
    repeats: Count
    order: Literal["randomised", "as_listed"]
    seed: Annotated[int, Field(ge=0)]
    picture_px: tuple[Count, Count]  # width, height that the camera is set to
    sync_light_px: tuple[Pixels, Pixels, Count, Count]  # x, y, width, height in the picture
    video_quality: Annotated[int, Field(ge=1, le=100)]

    @model_validator(mode="after")
    def _see_the_light(self) -> Self:
        x, y, width, height = self.sync_light_px
        if x + width > self.picture_px[0] or y + height > self.picture_px[1]:
            raise ValueError(
                f"sync_light_px {list(self.sync_light_px)} reaches out of the picture of "
                f"{self.picture_px[0]} × {self.picture_px[1]} px"
            )
        return self


class Plan(Settings):
    """The whole file.

    `campaign` contains the finger and camera sections of ``campaign.yaml``.
    """

    version: Literal[1]
    campaign: dict[str, Any]
    safety: Safety
    recording: Recording
    profiles: Annotated[list[Profile], Field(min_length=1)]

    @model_validator(mode="after")
    def _check_profiles(self) -> Self:
        repeated = [n for n, k in Counter(p.name for p in self.profiles).items() if k > 1]
        if repeated:
            raise ValueError(f"two profiles are called '{repeated[0]}'; give each its own name")
        limit = self.safety.tension_limit_n
        for profile in self.profiles:
            peak = profile.build_knots()[1].max()
            if peak > limit:
                raise ValueError(
                    f"profile '{profile.name}' pulls with {peak:g} N, but safety.tension_limit_n "
                    f"is {limit:g} N; lower the profile or raise the limit if the finger allows it"
                )
        return self

    @model_validator(mode="after")
    def _check_campaign(self) -> Self:
        described = self.describe_campaign("measured")
        try:
            camera = Description.model_validate(described).camera
        except ValidationError as error:
            fault = error.errors()[0]
            key = ".".join(map(str, fault["loc"]))
            raise ValueError(f"campaign.{key}: {fault['msg']}, got {fault['input']!r}") from None
        if camera is None:
            raise ValueError("campaign.camera is missing; a recording needs its frame rate")
        return self

    @property
    def fps(self) -> float:
        """The camera's declared frame rate [1/s]."""
        return float(self.campaign["camera"]["fps"])

    def describe_campaign(self, source: Literal["measured", "synthetic"]) -> dict[str, Any]:
        """Build the contents of ``campaign.yaml``."""
        return {"version": 1, **self.campaign, "source": source}


class PlannedTrial(NamedTuple):
    """One pull that is to be recorded."""

    name: str
    profile: Profile


def read_plan(path: Path) -> Plan:
    """Read a plan.

    Raises
    ------
    ListedFault
        The file is missing, no YAML, or asks for what no rig can do; all faults are listed.
    """
    try:
        content = read_document(path).content
    except Fault as fault:
        raise ListedFault(str(path), [str(fault)]) from None
    try:
        return read_settings(Plan, content, "plan")
    except ListedFault as fault:
        raise ListedFault(str(path), fault.faults) from None


def build_schedule(plan: Plan) -> list[PlannedTrial]:
    """List of trials, shuffled within each repeat.

    Every repeat contains every profile once.

    Shuffled by blocks, so that neither fatigue nor the weather of the day is confounded with a
    profile, and a campaign that ends early is still balanced. The same plan gives the same list.
    """
    rng = np.random.default_rng(plan.recording.seed)
    order = []
    for _ in range(plan.recording.repeats):
        block = np.arange(len(plan.profiles))
        order += list(rng.permutation(block) if plan.recording.order == "randomised" else block)
    width = max(3, len(str(len(order))))
    return [
        PlannedTrial(f"trial_{number:0{width}d}", plan.profiles[index])
        for number, index in enumerate(order, start=1)
    ]
