"""A proof's campaigns: a seeded, balanced draw."""

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from itertools import combinations, product
from typing import Literal, NamedTuple

import numpy as np

from softfinger.concealed.effects import CATALOGUES, OUTSIDERS
from softfinger.concealed.noise import NOISE_KINDS, NoiseKind
from softfinger.concealed.protocols import PROTOCOLS, Protocol
from softfinger.concealed.registry import EFFECTS

TRIALS = (1,) * 4 + (10,) * 9 + (40,) * 5 + (100,) * 2
FILMED_TRIALS = (4, 6, 8, 10)
JOINTS = 3
PLAIN = 0.75  # places on the scale of strengths from which an effect is plainly visible

Kind = Literal["sample", "catalogue"]
Catalogue = Literal["first", "second"]


@dataclass(frozen=True)
class CaseSpec:
    """One concealed campaign before anything in it is drawn.

    Attributes
    ----------
    seed
        Root of every draw of the campaign.
    effects
        Ids of what is switched on; none: a clean control.
    joints
        For every effect the joints that it acts on, from 0; empty where it is not tied to joints.
    quantiles
        For every effect its strength's place, from 0 to 1 on a logarithmic scale, between a gain of
        one nat and the largest gain that the oracle can reach with it in this campaign; −1: the
        strength is zero, so that the control is clean although an effect was asked for.
    filmed
        Recorded as raw video, not as angles.
    even
        The smallest of its effects' largest gains counts for all of them.
    strengths
        Strengths given outright, in place of the quantiles': for a case that is set, not drawn.
    nuisances
        Ids of the faults of the measurement.
    duration_s
        Of a trial; the load changes in proportion.
    catalogue
        Which ids the catalogue under test has.
    scatters
        Of every effect the sd of its strength's logarithm between trials; empty: none.
    """

    seed: int
    effects: tuple[str, ...]
    joints: tuple[tuple[int, ...], ...]
    quantiles: tuple[float, ...]
    protocol: Protocol
    trials: int
    noise: NoiseKind
    filmed: bool = False
    even: bool = False
    strengths: tuple[float, ...] = ()
    nuisances: tuple[str, ...] = ()
    duration_s: float = 40.0
    catalogue: Catalogue = "first"
    scatters: tuple[float, ...] = ()

    def to_json(self) -> dict:
        """Plain numbers, lists and words."""
        return asdict(self)


def build_paper_case(protocol: Protocol, trials: int, seed: int) -> CaseSpec:
    """Set the paper's own case.

    Its wire geometry moves the finger, its analysis leaves it out.
    """
    return CaseSpec(
        seed=seed,
        effects=("moment_arm",),
        joints=((),),
        quantiles=(1.0,),
        protocol=protocol,
        trials=trials,
        noise="white",
        strengths=(1.0,),
    )


def draw_catalogue(
    seed: int, n: int, *, longest: int = max(TRIALS), catalogue: Catalogue = "first"
) -> list[CaseSpec]:
    """Draw effects under every protocol, then pairs.

    Each as strong as the upper quarter of what the oracle can reach with it, on a logarithmic
    scale; what the protocol hides stays hidden. In a pair the weaker one's reach counts for both,
    for beside an effect of thousands of nats one of twenty is not plainly visible.

    Parameters
    ----------
    seed, n, longest, catalogue
        As for `draw_suite`.

    Examples
    --------
    >>> suite = draw_catalogue(1, 80)
    >>> sum(len(spec.effects) == 2 for spec in suite)
    12
    """
    rng = np.random.default_rng([seed, n, 2])
    listed = CATALOGUES[catalogue]
    singles = list(product(listed, PROTOCOLS))[:n]
    pairs = take_turns(tuple(combinations(listed, 2)), n - len(singles), rng)
    sets: list[tuple[str, ...]] = [*((name,) for name, _ in singles), *pairs]
    protocols = [protocol for _, protocol in singles] + take_turns(PROTOCOLS, len(pairs), rng)
    places = [tuple(float(rng.uniform(PLAIN, 1.0)) for _ in effects) for effects in sets]
    noises, lengths = take_turns(NOISE_KINDS, n, rng), take_turns(TRIALS, n, rng)
    drafts = map(_Draft, sets, places, protocols, noises, lengths, [False] * n)
    suite = _build_cases(drafts, longest, rng)
    return [replace(spec, even=True, catalogue=catalogue) for spec in suite]


def draw_suite(
    seed: int,
    n: int,
    *,
    filmed: int | None = None,
    longest: int = max(TRIALS),
    catalogue: Catalogue = "first",
) -> list[CaseSpec]:
    """Draw a balanced suite, in random order.

    At least a quarter are clean controls, over every kind of noise, two of them with an effect of
    strength zero; about an eighth have two effects, a sixth one from outside the catalogue, and
    the rest one of the catalogue, in turn. Protocols, lengths and noise take turns too, and the
    strengths of an effect's cases are spread evenly.

    Parameters
    ----------
    seed : int
        The same seed gives the same suite.
    filmed : int, optional
        How many are filmed: one in twenty, and at least one, if not said.
    longest : int
        Most trials that a campaign has; longer ones are cut to it.
    catalogue
        Which ids the catalogue under test has; what is not among them is from outside it.

    Examples
    --------
    >>> suite = draw_suite(1, 24)
    >>> len(suite), sum(not spec.effects for spec in suite) >= 4
    (24, True)
    """
    rng = np.random.default_rng([seed, n])
    listed, outsiders = CATALOGUES[catalogue], OUTSIDERS[catalogue]
    clean = math.ceil(0.26 * n)
    pairs, outside = round(0.12 * n), round(0.16 * n)
    single = n - clean - pairs - outside
    sets: list[tuple[str, ...]] = [()] * clean
    sets += [(name,) for name in take_turns(listed, single, rng)]
    sets += [(name,) for name in take_turns(outsiders, outside, rng)]
    sets += take_turns(tuple(combinations(listed, 2)), pairs, rng)
    protocols = take_turns(PROTOCOLS, n, rng)
    noises = take_turns(NOISE_KINDS, clean, rng) + take_turns(NOISE_KINDS, n - clean, rng)
    lengths = take_turns(TRIALS, n, rng)
    places = _spread(sets, rng)
    for zero in rng.choice(clean, min(2, clean // 3), replace=False):
        sets[zero], places[zero] = (listed[rng.integers(len(listed))],), (-1.0,)

    on_film = _choose_filmed(sets, max(1, n // 20) if filmed is None else filmed, rng)
    filmed_ones = [k in on_film for k in range(n)]
    drafts = map(_Draft, sets, places, protocols, noises, lengths, filmed_ones)
    return [replace(spec, catalogue=catalogue) for spec in _build_cases(drafts, longest, rng)]


class _Draft(NamedTuple):
    """What the draw settles of a case."""

    effects: tuple[str, ...]
    places: tuple[float, ...]
    protocol: Protocol
    noise: NoiseKind
    trials: int
    filmed: bool


def _build_cases(
    drafts: Iterable[_Draft], longest: int, rng: np.random.Generator
) -> list[CaseSpec]:
    """Build the cases, in random order."""
    suite = []
    for draft in drafts:
        fewest = max([EFFECTS[name].trials for name in draft.effects], default=1)
        trials = draft.trials if draft.trials >= fewest else int(rng.choice([10, 40]))
        if draft.filmed:
            trials = int(rng.choice(FILMED_TRIALS)) if fewest <= 4 else 10
        suite.append(
            CaseSpec(
                seed=int(rng.integers(2**63)),
                effects=draft.effects,
                joints=tuple(draw_joints(name, rng) for name in draft.effects),
                quantiles=draft.places,
                protocol=draft.protocol,
                trials=min(trials, longest),
                noise="white" if draft.filmed else draft.noise,
                filmed=draft.filmed,
            )
        )
    return [suite[k] for k in rng.permutation(len(suite))]


def take_turns[Item](items: tuple[Item, ...], n: int, rng: np.random.Generator) -> list[Item]:
    """Every item about equally often, randomly ordered."""
    rounds = [rng.permutation(len(items)) for _ in range(math.ceil(n / len(items)))]
    return [items[k] for k in np.concatenate([*rounds, []]).astype(int)[:n]]


def _spread(sets: list[tuple[str, ...]], rng: np.random.Generator) -> list[tuple[float, ...]]:
    """Even places on (0, 1), by shared effects."""
    places: list[tuple[float, ...]] = [()] * len(sets)
    for effects in dict.fromkeys(sets):
        cases = [k for k, other in enumerate(sets) if other == effects]
        columns = [
            (rng.permutation(len(cases)) + rng.uniform(size=len(cases))) / len(cases)
            for _ in effects
        ]
        for row, k in enumerate(cases):
            places[k] = tuple(float(column[row]) for column in columns)
    return places


def _choose_filmed(sets: list[tuple[str, ...]], n: int, rng: np.random.Generator) -> set[int]:
    """Cases that a camera can show."""
    fit = [k for k, names in enumerate(sets) if not any(EFFECTS[e].record for e in names)]
    return set(rng.choice(fit, min(n, len(fit)), replace=False).tolist())


def draw_joints(name: str, rng: np.random.Generator) -> tuple[int, ...]:
    """Draw the joints on which an effect acts."""
    where = EFFECTS[name].joints
    if where == "chain":
        return ()
    if where == "first":
        return (0,)
    if where == "pair":
        first = int(rng.integers(JOINTS - 1))
        return (first, first + 1)
    if where == "one" or rng.uniform() < 0.4:
        return (int(rng.integers(JOINTS)),)
    return tuple(range(JOINTS))
