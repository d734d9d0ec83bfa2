"""One trial: align clocks, pull, align again."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.rig.camera import FrameGrabber, StampedPicture
from softfinger.rig.clocks import (
    FLASHES,
    ClockOffset,
    FrameClock,
    compute_flash_duration,
    estimate_clock_offset,
    find_light_changes,
    fit_frame_clock,
)
from softfinger.rig.controller import Controller, Sample
from softfinger.rig.display import Display
from softfinger.rig.plan import Plan
from softfinger.rig.profiles import Knots


@dataclass(frozen=True)
class TrialRecording:
    """A finished trial; time 0 is its first frame.

    Attributes
    ----------
    started
        Controller time at which the profile started [s].
    sample_time, tension, current
        (sample,) [s], [N], [A], all samples since the wire was armed.
    load_start, load_end
        Times at which the profile started and ended [s].
    stamp
        (frame,) [s] on the camera's clock, NaN where the frame before replaces a lost one.
    pictures
        One JPEG per frame.
    rate
        Of the frames [1/s], as measured.
    jitter
        Root mean square of the stamps about a regular beat [s].
    before, after
        Offsets of the clocks before and after the pull.
    """

    started: float
    sample_time: NDArray[np.float64]
    tension: NDArray[np.float64]
    current: NDArray[np.float64]
    load_start: float
    load_end: float
    stamp: NDArray[np.float64]
    pictures: Sequence[bytes]
    rate: float
    jitter: float
    before: ClockOffset
    after: ClockOffset

    @property
    def n_dropped(self) -> int:
        """How many frames were lost."""
        return int(np.isnan(self.stamp).sum())


@dataclass(frozen=True)
class Pull:
    """One pull: controller's [s], camera's stamps [s]."""

    started: float
    ended: float
    samples: list[Sample]
    frames: list[StampedPicture]


class Rig:
    """Controller, camera and display, served all the time."""

    def __init__(
        self, controller: Controller, grabber: FrameGrabber, display: Display, plan: Plan
    ) -> None:
        self.controller = controller
        self.plan = plan
        self._grabber = grabber
        self._display = display

    def serve(self) -> list[StampedPicture]:
        """Serve everything once; frames since the last time."""
        self.controller.watch()
        frames = self._grabber.take()
        self._display.show_frames(frames)
        return frames

    def record_trial(self, knots: Knots) -> TrialRecording:
        """Record a trial; the wire is slack around it.

        Raises
        ------
        Fault
            Anything that spoils the trial; the wire may then still be pulled.
        """
        before = self._align_clocks()
        pull = self._pull(knots, before)
        after = self._align_clocks()
        _check_drift(before, after, self.plan.fps)
        return assemble_trial(pull, before, after, self.plan)

    def rest(self, duration: float) -> None:
        """Serve for a while [s, of the computer's clock]."""
        until = time.monotonic() + duration
        while time.monotonic() < until:
            self.serve()

    def _align_clocks(self) -> ClockOffset:
        self.serve()
        self.controller.flash(compute_flash_duration(self.plan.fps))
        edges: list[float] = []
        frames: list[StampedPicture] = []
        last_edge = time.monotonic()
        brightness = np.zeros(0)
        while len(edges) < 2 * FLASHES or find_light_changes(brightness).size < 2 * FLASHES:
            frames += self.serve()
            brightness = np.array([frame.brightness for frame in frames])
            edges += [moment for name, moment in self.controller.take_events() if name == "light"]
            if len(edges) < 2 * FLASHES:
                last_edge = time.monotonic()
            elif time.monotonic() - last_edge > self.plan.safety.camera_timeout_s:
                break  # the light has flashed, and whatever was seen of it was seen
        stamps = np.array([frame.stamp for frame in frames])
        return estimate_clock_offset(stamps, brightness, edges)

    def _pull(self, knots: Knots, offset: ClockOffset) -> Pull:
        controller, frames, samples = self.controller, self.serve(), []
        controller.arm(knots, self.plan.recording.stream_rate_hz)
        lead_in = self.plan.recording.lead_in_s
        while not samples or samples[-1].time < samples[0].time + lead_in:
            frames += self.serve()
            samples += self._take_samples()
        started, ended = controller.start(), np.nan
        while np.isnan(ended):
            frames += self.serve()
            samples += self._take_samples()
            ended = next((t for name, t in controller.take_events() if name == "finished"), np.nan)
        controller.release()
        samples += self._take_samples()
        while not frames or frames[-1].stamp <= ended + offset.offset:
            frames += self.serve()
        return Pull(started, ended, samples, frames)

    def _take_samples(self) -> list[Sample]:
        samples = self.controller.take_samples()
        if samples:
            self._display.show_tension(samples[-1].tension)
        return samples


def assemble_trial(
    pull: Pull, before: ClockOffset, after: ClockOffset, plan: Plan
) -> TrialRecording:
    """Put a pull's frames and samples into one time.

    A lost frame's place is taken by the frame before it, so that time in the video goes on.

    Raises
    ------
    Fault
        Too few frames, too many lost ones, a frame rate that is not the declared one, or no samples
        up to the end.
    """
    _check_samples(pull, plan.recording.stream_rate_hz)
    first, last = pull.started - plan.recording.lead_in_s, pull.ended
    frames = [f for f in pull.frames if first <= f.stamp - before.offset <= last]
    clock = fit_frame_clock(np.array([frame.stamp for frame in frames]), plan.fps)
    shown, stamp = _fill_gaps(clock, frames)
    lost = int(np.isnan(stamp).sum())
    allowed = plan.safety.dropped_frames_share
    if lost > allowed * stamp.size:
        raise Fault(
            f"the camera lost {lost} of {stamp.size} frames, more than the share "
            f"safety.dropped_frames_share {allowed:g}; free the computer or its USB bus, or lower "
            "the frame rate"
        )
    to_video = before.offset - clock.start
    return TrialRecording(
        started=pull.started,
        sample_time=np.array([sample.time for sample in pull.samples]) + to_video,
        tension=np.array([sample.tension for sample in pull.samples]),
        current=np.array([sample.current for sample in pull.samples]),
        load_start=pull.started + to_video,
        load_end=pull.ended + to_video,
        stamp=stamp,
        pictures=[frames[index].jpeg for index in shown],
        rate=clock.rate,
        jitter=clock.jitter,
        before=before,
        after=after,
    )


def _check_samples(pull: Pull, rate_hz: float) -> None:
    """Refuse a pull whose last samples are missing."""
    sampled = pull.samples[-1].time
    if sampled < pull.ended - 1.5 / rate_hz:
        raise Fault(
            f"the tension was sampled for {sampled - pull.started:.2f} s of a pull of "
            f"{pull.ended - pull.started:.2f} s; check that its load cell is connected"
        )


def _fill_gaps(
    clock: FrameClock, frames: Sequence[StampedPicture]
) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
    """Frame at each beat; stamp NaN if lost."""
    beat = np.arange(clock.slot[-1] + 1)
    shown = np.searchsorted(clock.slot, beat, side="right") - 1
    stamp = np.full(beat.size, np.nan)
    stamp[clock.slot] = [frame.stamp for frame in frames]
    return shown, stamp


def _check_drift(before: ClockOffset, after: ClockOffset, fps: float) -> None:
    drift = after.offset - before.offset
    allowed = 1 / fps + before.uncertainty + after.uncertainty
    if abs(drift) > allowed:
        raise Fault(
            f"the camera's clock moved by {drift * 1e3:.1f} ms against the controller's during the "
            f"trial; expected at most {allowed * 1e3:.1f} ms: the camera loses or stamps frames "
            "wrongly"
        )
