"""Recordings set right, with the base model fitted."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbances import CLOCKS, DRIFTS, SIZES, find_kind
from softfinger.inference.disturbed import admit_disturbances
from softfinger.inference.problem import Candidate, Problem
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.measure import add_components
from softfinger.measurement.mend import READINGS, mend_recordings, read_every_row
from softfinger.measurement.steady import steady_log
from softfinger.measurement.step_time import find_step_gaps_array
from softfinger.measurement.tare import tare_log
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import ScoreColumns, collect_columns
from softfinger.mismatch.candidates.rank import Progress, Score, rank_pieces
from softfinger.mismatch.checks.hums import Hum, describe_hums, hear_hums
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.calibrate import FalseAlarms
from softfinger.mismatch.search.demand import Demand, build_demand, list_free
from softfinger.mismatch.search.eliminate import choose_top
from softfinger.mismatch.search.extend import Task
from softfinger.mismatch.search.finalists import find_leader, list_leaders
from softfinger.mismatch.search.judge import fit_again, judge
from softfinger.mismatch.search.log_and_clock import (
    find_clock_rate,
    find_common,
    start_clocks,
    weigh_log,
)
from softfinger.mismatch.search.place_steps import PlacedSteps, describe_steps, place_steps
from softfinger.mismatch.search.stepwise import Search, search_effects


class Survey(NamedTuple):
    """The catalogue alone: columns, chance, need, ranking."""

    catalogue: tuple[list[Piece], dict[str, str]]
    columns: ScoreColumns
    alarms: FalseAlarms
    needed: float
    ranked: tuple[list[Candidate], list[Score]]

    @property
    def demand(self) -> Demand:
        """What a first and a further effect must gain [nats]."""
        pieces = self.catalogue[0]
        effects = len({piece.effect.id for piece in pieces})
        return build_demand(self.needed, effects, list_free(pieces))

    def join_leaders(self, problem: Problem, base: Candidate, leaders: list[Candidate]) -> "Survey":
        """Let leaders of an earlier survey compete, refitted.

        A survey fits each effect from its null, and gives most of its time to what scores best
        there. Under another measurement that may be others than those that led, far off their null.
        """
        singles = {candidate.model.label: candidate for candidate in self.ranked[0]}
        for leader in leaders:
            again, label = fit_again(problem, leader, base), leader.model.label
            if again is not None:
                singles[label] = choose_top([singles.get(label, again), again], again)
        order = sorted(singles.values(), key=lambda c: -c.log_evidence)
        return self._replace(ranked=(order, self.ranked[1]))

    def search(
        self, problem: Problem, base: Candidate, progress: Progress, worth: float = 0.0
    ) -> Search:
        """Search for effects that act together.

        `worth` as in `search_effects`.
        """
        return search_effects(self.build_task(problem, base, progress), self.needed, worth)

    def build_task(self, problem: Problem, base: Candidate, progress: Progress) -> Task:
        """What a search of the catalogue is given."""
        return Task(problem, base, *self.catalogue, self.columns, *self.ranked, progress)


class Posed(NamedTuple):
    """Recordings with the base model fitted to them.

    They were set right by `mended`; `known` has what was wrong with log and clock: component →
    size and evidence [nats].
    """

    angles: xr.Dataset
    plain: Problem
    base: Candidate
    survey: Survey
    known: Mapping[str, tuple[float, float]]
    mended: MeasurementEntry


AS_LOGGED = MeasurementEntry().model_dump(include={"steps_early", "steps_open", "step_shares"})
"""Steps at the later of the two rows that state them."""
STEPS = frozenset({"step_time", "step_moments"})

Pose = Callable[[MeasurementEntry, Mapping[str, tuple[float, float]]], Posed]


def pose_load(angles: xr.Dataset, pose: Pose) -> Posed:
    """Choose the load that the motion prefers.

    Plateaus are steady and ramps straight unless it prefers every reading, by more than the best
    effect alone may leave of the motion; steps are placed within their gaps. A load that turns in
    every row costs most of a diagnosis, so the steady one comes first.
    """
    steady, error = steady_log(angles)
    differs = not steady.equals(angles)
    posed = mend_steps(pose(MeasurementEntry(steady_load=differs), {}), pose)
    posed = choose_reading(angles, posed, pose)
    if not differs:
        return posed
    survey = posed.survey
    raw = mend_recordings(angles, read_every_row(posed.mended))
    more = weigh_log(posed.plain, posed.base, survey.ranked[0], raw, survey.needed)
    leader = find_leader(posed.base, survey.ranked[0], survey.needed)
    left = DECISIONS.form_error * (leader.log_evidence - posed.base.log_evidence)
    if more >= MEASURING.present_nats + left:
        followed = MeasurementEntry(load_tared=posed.mended.load_tared)
        zero = {name: found for name, found in posed.known.items() if name == "load_zero"}
        return mend_steps(pose(followed, zero), pose)
    slight = error < min(SIZES["noisy_load"])  # a good cell scatters as much
    if more >= 0.0 or slight or not np.isfinite(more):  # of no fit there is no evidence
        return posed
    noise = add_components(posed.plain.noise, {"noisy_load": error}, {"noisy_load": -more})
    known = {**posed.known, "noisy_load": (error, -more)}
    return posed._replace(plain=replace(posed.plain, noise=noise), known=known)


def choose_reading(angles: xr.Dataset, posed: Posed, pose: Pose) -> Posed:
    """Read the log otherwise where the motion prefers it.

    Each row of a ramp may stay until the next one: under lines from row to row such a load is half
    a row late. What the log reads at the start may be its zero: as a load it would move the finger.
    """
    plain, survey, as_read = posed.plain, posed.survey, mend_recordings(angles, posed.mended)
    chosen: dict[str, float] = {}
    for name, read in READINGS.items():
        other = mend_recordings(angles, read(posed.mended))
        if not other.equals(as_read):
            more = weigh_log(plain, posed.base, survey.ranked[0], other, survey.needed)
            chosen |= {name: more} if more >= MEASURING.reading_nats else {}
    if not chosen:
        return posed
    known = dict(posed.known)
    if "load_tared" in chosen:
        known["load_zero"] = tare_log(as_read)[1], chosen["load_tared"]
    mended = posed.mended
    for name in chosen:
        mended = READINGS[name](mended)
    return pose(mended, known)


def mend_steps(posed: Posed, pose: Pose) -> Posed:
    """Place the load's steps within the gaps of its log.

    Where a log is as slow as the frames, all motion seems too early: no delay of the camera, which
    the log cannot show. What leads once they are placed may be another effect, with other moments.
    """
    plain, trials = posed.plain, posed.plain.trials
    gaps = find_step_gaps_array(trials.load_time, trials.load_torque, trials.interval)
    gap = float(gaps.max(initial=0.0))
    if not plain.setting.load_known or gap <= plain.setting.time_floor:
        return posed
    survey = posed.survey
    steps = place_steps(plain, posed.base, survey.ranked[0], survey.needed)
    if not steps.nats:
        return posed
    placed = _pose_steps(posed, steps, pose)
    leader = find_leader(placed.base, placed.survey.ranked[0], survey.needed)
    again = fit_again(plain, leader, posed.base) if leader is not placed.base else None
    if again is None:
        return placed
    more = place_steps(plain, posed.base, [again], survey.needed)
    better = more.evidence > steps.evidence + MEASURING.present_nats
    return _pose_steps(posed, more, pose) if better else placed


def _pose_steps(posed: Posed, steps: PlacedSteps, pose: Pose) -> Posed:
    placed, found = describe_steps(posed.plain, steps)
    return pose(posed.mended.model_copy(update=placed), {**posed.known, **found})


def mend_clock(posed: Posed, pose: Pose) -> Posed:
    """Set the camera's clock to the log's rate.

    It is set where that explains more than any effect alone, less what chance gains. Under one
    step of the load a rate moves the step, as a clock that starts elsewhere does.
    """
    plain, base, found = posed.plain, posed.base, posed.survey
    if not plain.setting.load_known or CLOCKS.isdisjoint(fit_disturbances(plain, base)[0]):
        return posed
    rate, nats = find_clock_rate(plain, base)
    rival = find_leader(base, found.ranked[0], found.needed).log_evidence - base.log_evidence
    if nats < max(MEASURING.present_nats, rival - found.needed):
        return posed
    mended = posed.mended.model_copy(update={"clock_rate": rate})
    return pose(mended, {**posed.known, "clock_rate": (abs(rate), nats)})


def mend_offsets(posed: Posed, pose: Pose) -> Posed:
    """Start each trial's clock where its motion has it.

    To first order offsets are a disturbance, and all models are judged with that. They are set
    right where what leads then is better than whatever leads so, also with a second effect: more
    than a slope describes, and than a model that is left too small does.
    """
    plain, base, (singles, _) = posed.plain, posed.base, posed.survey.ranked
    needed = posed.survey.needed
    if not plain.setting.load_known:
        return posed
    leader = find_leader(base, singles, needed)
    first = start_clocks(plain, leader, base)
    if first is None:  # what it leaves shows no offsets, and no other leaves less
        return posed
    tried = [base, *list_leaders(base, singles, needed)]
    others = (start_clocks(plain, c, base) for c in tried if c is not leader)
    started = [first, *(one for one in others if one is not None)]
    before = _weigh_best([(plain, c, 0.0) for c in tried], base, needed)
    after = [
        _weigh_best([(s.problem, s.candidate, s.cost + needed)], base, needed) for s in started
    ]
    if max(after) < before + MEASURING.present_nats:
        return posed
    pairs = [(plain, pair, 0.0) for pair in _add_effect(posed, leader)]
    before = max(before, _weigh_best(pairs, base, needed))
    if max(after) < before + MEASURING.present_nats:
        return posed
    best = started[int(np.argmax(after))]
    offset = best.offset - find_common(best.offset)
    offsets = dict(zip(plain.trials.name, offset.tolist(), strict=True))
    mended = posed.mended.model_copy(update={"clock_offsets_s": offsets})
    sd = float(np.sqrt(np.mean(offset**2)))
    return pose(mended, {**posed.known, "clock_offset": (sd, max(after) - before)})


def _add_effect(posed: Posed, leader: Candidate) -> list[Candidate]:
    """The best models of a leader and one more effect."""
    plain, found = posed.plain, posed.survey
    pieces = [piece for piece in found.catalogue[0] if piece.effect.id not in leader.model.ids]
    columns = collect_columns(plain, leader, pieces)
    pairs, _ = rank_pieces(plain, leader, columns, lambda items, _: items)
    return [pair for pair in pairs if pair.fit is not None][: BUDGET.offset_rivals]


def _weigh_best(
    tried: list[tuple[Problem, Candidate, float]], base: Candidate, needed: float
) -> float:
    """Evidence [nats] of the best, with its own measurement.

    Each counts less what its numbers cost, and less what chance gains by an effect.
    """
    found = [
        judged.evidence - cost - needed * len(candidate.model.ids - base.model.ids)
        for problem, candidate, cost in tried
        if (judged := judge(problem, candidate, problem, base)) is not None
    ]
    return max(found, default=-np.inf)


def mend_hums(posed: Posed, pose: Pose) -> tuple[Posed, list[Hum]]:
    """Take hums, neither motion nor noise, off recordings.

    A few slow waves imitate a drift. They are hums where they explain more than it does. What a log
    or a clock that errs makes of the motion is no hum. Steps that come at any moment take up a part
    of a wave, so they are placed anew without it.
    """
    leader = find_leader(posed.base, posed.survey.ranked[0], posed.survey.needed)
    hums = hear_hums(posed.plain, leader, posed.angles)
    if not hums:
        return posed, hums
    size, found, directions = fit_disturbances(posed.plain, leader)
    known = {name: sd for name, sd in size.items() if find_kind(name) not in (None, *DRIFTS)}
    if known:
        softer = admit_disturbances(posed.plain, known, directions)
        again = fit_again(softer, leader, posed.base)
        hums = hums if again is None else hear_hums(softer, again, posed.angles)
    drift = sum(nats for name, nats in found.items() if find_kind(name) in DRIFTS)
    if not hums or drift > sum(hum.evidence for hum in hums):
        return posed, []
    mended = add_hums(posed.mended, hums, posed.plain.trials.name)
    as_logged = mended.model_copy(update=AS_LOGGED)
    if mended == as_logged:
        return pose(mended, posed.known), hums
    known = {name: found for name, found in posed.known.items() if name not in STEPS}
    return mend_steps(pose(as_logged, known), pose), hums


def add_hums(known: MeasurementEntry, hums: list[Hum], trials: list[str]) -> MeasurementEntry:
    """Add hums of some trials to what is known."""
    return known.model_copy(update={"hums": [*known.hums, *describe_hums(hums, trials)]})
