"""Campaigns whose effects follow foreign laws."""

import numpy as np

from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.foreign import FOREIGN
from softfinger.concealed.noise import NOISE_KINDS
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.suite import CaseSpec, Catalogue, draw_joints, take_turns

TRIALS = (10, 20, 40)
PLACES = (0.5, 1.0)  # on the scale of strengths
SCATTER = (0.1, 0.3)  # of a strength's logarithm between trials, where it varies
KINDS = ("single", "single", "varies", "pair")  # take turns


def draw_foreign(
    seed: int, n: int, *, longest: int = max(TRIALS), catalogue: Catalogue = "first"
) -> list[CaseSpec]:
    """Draw campaigns with foreign laws of listed effects.

    Laws take turns. Half of the campaigns have one, a quarter one whose strength varies between
    trials, a quarter two, whose smaller reach counts for both.

    Examples
    --------
    >>> suite = draw_foreign(1, 40)
    >>> sum(len(spec.effects) == 2 for spec in suite), sum(any(s.scatters) for s in suite)
    (10, 10)
    """
    rng = np.random.default_rng([seed, n, 5])
    laws = tuple(name for name, law in FOREIGN.items() if law.id in CATALOGUES[catalogue])
    kinds, lengths = take_turns(KINDS, n, rng), take_turns(TRIALS, n, rng)
    protocols, noises = take_turns(PROTOCOLS, n, rng), take_turns(NOISE_KINDS, n, rng)
    suite = []
    for k, first in enumerate(take_turns(laws, n, rng)):
        names = (first, _draw_partner(first, laws, rng)) if kinds[k] == "pair" else (first,)
        trials = max(lengths[k], *(FOREIGN[name].trials for name in names))
        suite.append(
            CaseSpec(
                seed=int(rng.integers(2**63)),
                effects=names,
                joints=tuple(draw_joints(name, rng) for name in names),
                quantiles=tuple(float(rng.uniform(*PLACES)) for _ in names),
                protocol=protocols[k],
                trials=min(trials, longest),
                noise=noises[k],
                even=len(names) == 2,
                catalogue=catalogue,
                scatters=(float(rng.uniform(*SCATTER)),) if kinds[k] == "varies" else (),
            )
        )
    return suite


def _draw_partner(first: str, laws: tuple[str, ...], rng: np.random.Generator) -> str:
    """Draw a law of another effect."""
    others = [name for name in laws if FOREIGN[name].id != FOREIGN[first].id]
    return others[rng.integers(len(others))]
