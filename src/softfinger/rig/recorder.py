"""The recording session, until the plan is done."""

import math
from collections.abc import Mapping
from datetime import timedelta
from pathlib import Path

from softfinger.rig.camera import FrameGrabber, open_camera
from softfinger.rig.controller import connect_controller
from softfinger.rig.display import Display
from softfinger.rig.folder import PREVIEW, RecordingFolder, open_folder
from softfinger.rig.plan import PlannedTrial, build_schedule, read_plan
from softfinger.rig.trial import Rig, TrialRecording

_BYTES_PER_FRAME = 400_000  # a compressed picture of a few megapixels


def record_campaign(
    plan_file: Path, folder: Path, port: str, camera: str, environment: Mapping[str, float]
) -> None:
    """Record the plan's trials that the folder misses.

    Parameters
    ----------
    plan_file
        See docs/rig/plan.yaml.
    folder
        The campaign folder; begun when absent or empty, else gone on with.
    port
        Of the motor controller: a device path, or a URL of pyserial.
    camera
        A number or path for OpenCV, or ``virtual:PORT`` of a simulator.
    environment
        Columns of ``trials.csv`` for this session, beside what the controller measures.

    Raises
    ------
    Fault
        The recording ended early; the sentence states why and what is known of the wire. Finished
        trials are whole, and the same call goes on.
    """
    plan = read_plan(plan_file)
    schedule = build_schedule(plan)
    # The controller is left first: the wire goes slack before a hanging camera is waited for.
    with (
        FrameGrabber(open_camera(camera, plan), plan) as grabber,
        connect_controller(port, plan) as controller,
    ):
        simulated = controller.identity.simulated
        into = open_folder(folder, plan, plan_file.read_text(encoding="utf-8"), simulated)
        left = [planned for planned in schedule if planned.name not in into.finished]
        preview = into.path / PREVIEW
        with Display(len(schedule), len(into.finished), plan.fps, preview) as display:
            rig = Rig(controller, grabber, display, plan)
            _record(left, rig, into, display, environment)


def _record(
    left: list[PlannedTrial],
    rig: Rig,
    into: RecordingFolder,
    display: Display,
    environment: Mapping[str, float],
) -> None:
    controller = rig.controller
    for planned in left:
        if into.finished:
            rig.rest(rig.plan.recording.rest_s / controller.identity.time_scale)
        knots = planned.profile.build_knots()
        duration = rig.plan.recording.lead_in_s + knots[0][-1]
        into.require_space(math.ceil(duration * rig.plan.fps) * _BYTES_PER_FRAME)
        display.begin_trial(planned.name, planned.profile.name)
        noted = {**controller.read_environment(), **environment}
        recording = rig.record_trial(knots)
        started_at = controller.identity.zero + timedelta(seconds=recording.started)
        into.add(planned, recording, started_at, noted)
        display.end_trial(_summarise(planned, recording))


def _summarise(planned: PlannedTrial, recording: TrialRecording) -> str:
    drift = recording.after.offset - recording.before.offset
    return (
        f"{planned.name} ({planned.profile.name}): up to {recording.tension.max():.2f} N, "
        f"{recording.stamp.size} frames at {recording.rate:.4g}/s, {recording.n_dropped} lost; "
        f"clocks aligned to ± {recording.before.uncertainty * 1e3:.1f} ms, drift "
        f"{drift * 1e3:+.1f} ms"
    )
