"""Recordings that copy a part of each other, or of themselves."""

from collections.abc import Iterator, Sequence

from softfinger.doubts.doubt import Doubt, list_briefly, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.windows import Stretch, find_stretches

SHARED = 0.3  # of a recording's frames: more of it is a copy, less a part that was pasted


def doubt_copies(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt trials that repeat another's frames, or their own."""
    between: dict[tuple[int, int], list[Stretch]] = {}
    within: dict[int, list[Stretch]] = {}
    for stretch in find_stretches([trial.angle for trial in trials]):
        if stretch.first == stretch.second:
            within.setdefault(stretch.first, []).append(stretch)
        else:
            between.setdefault((stretch.first, stretch.second), []).append(stretch)
    copies: dict[int, set[int]] = {}
    parts: list[Stretch] = []
    for (first, second), stretches in between.items():
        shorter = min(trials[k].angle.shape[1] for k in (first, second))
        if sum(stretch.frames for stretch in stretches) > SHARED * shorter:
            copies.setdefault(first, {first}).add(second)
        else:
            parts.append(max(stretches, key=lambda stretch: stretch.frames))
    for members in copies.values():
        names = [trials[number].name for number in sorted(members)]
        yield Doubt(
            "copies",
            f"the recordings of {name_trials(names, len(trials))} are copies of each other "
            f"({list_briefly(names)}), whole or in part; likely one file that was saved under "
            "two names; give each trial its own recording",
            tuple(names),
        )
    if parts:
        yield _describe_parts(trials, parts)
    if within:
        longest = [max(found, key=lambda stretch: stretch.frames) for found in within.values()]
        yield _describe_repeats(trials, longest)


def _describe_parts(trials: Sequence[TrialFeatures], parts: list[Stretch]) -> Doubt:
    part = max(parts, key=lambda stretch: stretch.frames)
    first, second = trials[part.first], trials[part.second]
    names = tuple(sorted({trials[k].name for p in parts for k in (p.first, p.second)}))
    others = f" (and so in {len(parts) - 1} more pairs of trials)" if len(parts) > 1 else ""
    return Doubt(
        "shared_part",
        f"{part.frames} frames of trial {second.name}, from {second.time[part.at_frame]:.4g} s, "
        f"are those of trial {first.name} from {first.time[part.from_frame]:.4g} s{others}; likely "
        "rows that were pasted into the wrong file; export these recordings again",
        names,
    )


def _describe_repeats(trials: Sequence[TrialFeatures], longest: list[Stretch]) -> Doubt:
    part = max(longest, key=lambda stretch: stretch.frames)
    trial = trials[part.first]
    names = tuple(trials[p.first].name for p in longest)
    return Doubt(
        "repeated_part",
        f"in {name_trials(names, len(trials))} the same frames occur twice: in {trial.name} "
        f"{part.frames} frames from {trial.time[part.at_frame]:.4g} s are those from "
        f"{trial.time[part.from_frame]:.4g} s; likely rows that were pasted or logged twice; "
        "export the recording again",
        names,
    )
