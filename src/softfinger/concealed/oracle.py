"""The evidence that the true physics gains.

The oracle fits the true physics in its true form: the limit that no tool can beat.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from softfinger.concealed.arrays import Array
from softfinger.concealed.blur import Blur
from softfinger.concealed.effects import Circumstances, Dose
from softfinger.concealed.forward import compute_plain_angles, simulate_trial
from softfinger.concealed.kernel import RunawayError
from softfinger.concealed.knobs import Knobs
from softfinger.concealed.mixed_effects import Linearised, Solution, solve_mixed_model
from softfinger.concealed.noise import Noise, whiten
from softfinger.concealed.population import PAPER_MEAN
from softfinger.concealed.rig import Rig

LONGEST_MOVE = np.repeat([0.7, 0.7, 1.0, 0.05], PAPER_MEAN.shape[1])  # of η in one iteration
NUDGE = 1e-3
TOLERANCE_RAD = 3e-8
SETTLED_NATS = 0.05


@dataclass(frozen=True)
class Recording:
    """One trial with all that the oracle knows."""

    time: Array  # (frame,) of the frames that show something
    angle: Array  # (frame, joint)
    trial: Circumstances
    blur: Blur | None = None  # what is known of the measurement; None: no more than the noise

    def whiten(self, noise: Noise, signal: Array) -> Array:
        """Whiten a signal (frame, joint) by the trial's errors."""
        return self.blur.whiten(signal) if self.blur else whiten(noise, self.time, signal)


@dataclass(frozen=True)
class Fit:
    """A model fitted to a campaign, trials integrated."""

    log_evidence: float
    solution: Solution
    doses: dict[str, Dose]
    settled: bool
    residuals: list[Array]  # whitened (frame, joint) of every trial at its mode


def compute_angles(
    individual: Array, doses: dict[str, Dose], recording: Recording, rig: Rig
) -> Array:
    """Angles (frame, joint) [rad] of a trial's parameters."""
    trial, time = recording.trial, recording.time
    if doses:
        return simulate_trial(individual, doses, trial, rig, time, TOLERANCE_RAD)
    return compute_plain_angles(individual, trial, rig.wire_offset, time)


def fit_model(
    recordings: list[Recording],
    rig: Rig,
    noise: Noise,
    doses: dict[str, Dose],
    start: Array,
    *,
    times: float = 1.0,
    iterations: int = 25,
) -> Fit:
    """Fit the base model or the true physics.

    Without doses it is the base model. Gauss–Newton runs on the whole population.

    Parameters
    ----------
    doses
        Where the effects' parameters start; joints and choices stay.
    start : array (trial, parameter, joint)
        Where each trial's own parameters start.
    times
        How many trials like it each recording represents.
    """
    knobs, own = Knobs.of(doses), start[0].size
    seen = [r.whiten(noise, r.angle).ravel() for r in recordings]

    def look(k: int, point: Array) -> Array:
        """Whitened residual of a trial."""
        r, individual = recordings[k], point[:own].reshape(start[0].shape)
        angle = compute_angles(individual, knobs.turn(point[own:]), r, rig)
        return seen[k] - r.whiten(noise, angle).ravel()

    first = knobs.read()
    lines = [Line(look, k, np.append(eta, first)) for k, eta in enumerate(start)]
    solution, settled = _settle(lines, knobs, times, iterations)
    # half-normal priors: twice the share of the posterior in which a strength is positive
    positive = norm.logcdf((solution.effect / solution.effect_sd)[knobs.is_strength])
    return Fit(
        log_evidence=solution.log_evidence + float(np.sum(np.log(2.0) + positive)),
        solution=solution,
        doses=knobs.turn(np.maximum(solution.effect, knobs.floor)),
        settled=settled,
        residuals=[line.residual.reshape(-1, rig.joints) for line in lines],
    )


def _settle(
    lines: list[Line], knobs: Knobs, times: float, iterations: int
) -> tuple[Solution, bool]:
    """Move the lines until they are at modes."""
    longest = np.concatenate([LONGEST_MOVE, knobs.sd])
    lowest = np.concatenate([np.full(LONGEST_MOVE.size, -np.inf), knobs.floor])
    solution = solve_mixed_model(_collect(lines, times), knobs.centre, knobs.sd)
    for left in range(iterations, -1, -1):
        modes = np.maximum(solution.point, lowest)
        worth = np.array([line.worth(mode) for line, mode in zip(lines, modes, strict=True)])
        settled = bool(times * worth.sum() < SETTLED_NATS)
        if settled or left == 0:
            break
        for k in np.flatnonzero(worth > 0.1 * SETTLED_NATS / len(lines)):
            step = np.clip(modes[k] - lines[k].point, -longest, longest)
            lines[k].advance(step, solution)
        linear = _collect(lines, times)
        solution = solve_mixed_model(linear, knobs.centre, knobs.sd, solution.log_spread)
    return solution, settled


class Line:
    """One trial, linearised at a point."""

    def __init__(self, look: Callable[[int, Array], Array], k: int, point: Array) -> None:
        self._look = lambda there: look(k, there)
        self.point = point
        self.residual = self._look(point)
        self._renew()

    def _renew(self) -> None:
        nudged = self.point + NUDGE * np.eye(self.point.size)
        columns = [(self.residual - self._look(there)) / NUDGE for there in nudged]
        self.design = np.column_stack(columns)
        self.gram = self.design.T @ self.design

    def _look_ahead(self, there: Array) -> Array | None:
        try:
            return self._look(there)
        except RunawayError:
            return None

    def worth(self, there: Array) -> float:
        """Distance of a point, in nats of its misfit."""
        step = there - self.point
        return 0.5 * step @ self.gram @ step

    def advance(self, step: Array, solution: Solution) -> None:
        """Move by a share of a step, as trusted.

        Where even a small part of it runs away, the point stays.
        """

        def misfit(point: Array, residual: Array) -> float:
            off = (point[: solution.mean.size] - solution.mean) * np.exp(-solution.log_spread)
            return 0.5 * (residual @ residual + off @ off)

        straight = True
        for _ in range(7):
            there = self.point + step
            residual = self._look_ahead(there)
            if residual is not None:
                bend = residual - (self.residual - self.design @ step)
                excess = misfit(there, residual) - misfit(there, residual - bend)
                if excess <= 0.2 * self.worth(there) + 1e-3:
                    break
            step, straight = 0.5 * step, False
        if residual is None:
            return
        straight = straight and bend @ bend < 1e-3 * (1.0 + 2.0 * self.worth(there))
        self.point, self.residual = there, residual
        if not straight:
            self._renew()


def _collect(lines: list[Line], times: float) -> Linearised:
    return Linearised(
        np.stack([line.gram for line in lines]),
        np.stack([line.design.T @ line.residual for line in lines]),
        np.array([line.residual @ line.residual for line in lines]),
        np.stack([line.point for line in lines]),
        times,
    )


def compute_gain(
    recordings: list[Recording],
    rig: Rig,
    noise: Noise,
    doses: dict[str, Dose],
    start: Array,
    *,
    times: float = 1.0,
) -> tuple[float, Fit, Fit]:
    """Evidence gain [nats] of the true physics.

    The gain is over the base model; both fits are returned too.
    """
    base = fit_model(recordings, rig, noise, {}, start, times=times)
    true = fit_model(recordings, rig, noise, doses, start, times=times)
    return true.log_evidence - base.log_evidence, base, true


def expect_gain(
    clean: list[Recording],
    rig: Rig,
    noise: Noise,
    doses: dict[str, Dose],
    start: Array,
    *,
    times: float = 1.0,
) -> float:
    """Evidence gain [nats] that noise leaves on average.

    The recordings are free of noise.

    At its own parameters the true physics leaves no residual, so one linearisation there is
    enough; noise adds half a nat for each parameter that it has more than the base model.
    """
    base = fit_model(clean, rig, noise, {}, start, times=times)
    true = fit_model(clean, rig, noise, doses, start, times=times, iterations=0)
    return true.log_evidence - base.log_evidence + 0.5 * true.solution.effect.size
