"""Campaigns that are recorded unkindly."""

from dataclasses import replace

import numpy as np

from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.noise import NOISE_KINDS
from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.suite import CaseSpec, Catalogue, draw_joints, take_turns

SEVERAL = 2  # of this many more conditions several nuisances act at once
MOST_AT_ONCE = 4
CLEAN_TRIALS, CLEAN_S = (1, 4, 6, 8, 10, 12), 20.0
TWIN_TRIALS, TWIN_S = (10, 14, 20), 30.0
TWIN_PLACES = (0.5, 1.0)  # on the scale of strengths, so that most are visible


def draw_clean(seed: int, n: int) -> list[CaseSpec]:
    """Draw short clean campaigns with nuisances.

    Conditions, protocols, kinds of noise and lengths take turns.

    Examples
    --------
    >>> suite = draw_clean(1, 38)
    >>> len({spec.nuisances for spec in suite if len(spec.nuisances) == 1})
    17
    """
    rng = np.random.default_rng([seed, n, 3])
    single: list[tuple[str, ...]] = [(name,) for name in NUISANCES]
    conditions = take_turns((*single, *[()] * SEVERAL), n, rng)
    drawn = zip(
        [nuisances or _draw_several(rng) for nuisances in conditions],
        take_turns(PROTOCOLS, n, rng),
        take_turns(NOISE_KINDS, n, rng),
        take_turns(CLEAN_TRIALS, n, rng),
        strict=True,
    )
    return [
        CaseSpec(
            seed=int(rng.integers(2**63)),
            effects=(),
            joints=(),
            quantiles=(),
            protocol=protocol,
            trials=max([trials, *(NUISANCES[name].trials for name in nuisances)]),
            noise=noise,
            nuisances=nuisances,
            duration_s=CLEAN_S,
        )
        for nuisances, protocol, noise, trials in drawn
    ]


def draw_twins(seed: int, n: int, catalogue: Catalogue = "first") -> list[CaseSpec]:
    """Draw pairs of campaigns, without and with nuisances.

    A pair has one seed, so the same finger, trials, noise and strength; two of three pairs have
    one nuisance, the others several.

    Examples
    --------
    >>> kind, unkind = draw_twins(1, 1)
    >>> kind.seed == unkind.seed, kind.nuisances, len(unkind.nuisances) > 0
    (True, (), True)
    """
    rng = np.random.default_rng([seed, n, 4])
    effects = take_turns(CATALOGUES[catalogue], n, rng)
    single = take_turns(tuple(NUISANCES), n, rng)
    at_once = take_turns((False, False, True), n, rng)
    protocols, lengths = take_turns(PROTOCOLS, n, rng), take_turns(TWIN_TRIALS, n, rng)
    suite = []
    for k, name in enumerate(effects):
        spec = CaseSpec(
            seed=int(rng.integers(2**63)),
            effects=(name,),
            joints=(draw_joints(name, rng),),
            quantiles=(float(rng.uniform(*TWIN_PLACES)),),
            protocol=protocols[k],
            trials=max(lengths[k], EFFECTS[name].trials),
            noise=NOISE_KINDS[rng.integers(len(NOISE_KINDS))],
            duration_s=TWIN_S,
            catalogue=catalogue,
        )
        nuisances = _draw_several(rng) if at_once[k] else (single[k],)
        suite += [spec, replace(spec, nuisances=nuisances)]
    return suite


def _draw_several(rng: np.random.Generator) -> tuple[str, ...]:
    """Draw two or more nuisances that act together."""
    count = int(rng.integers(2, MOST_AT_ONCE + 1))
    return tuple(
        np.array(list(NUISANCES))[np.sort(rng.permutation(len(NUISANCES))[:count])].tolist()
    )
