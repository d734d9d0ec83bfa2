"""Trials whose parameters scatter as Laplace's law."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Array, Fault, Nuisance, Random
from softfinger.concealed.population import Population


def _people(individuals: Array, population: Population, fault: Fault, rng: Random) -> Array:
    """Draw every parameter anew.

    It has the same mean and sd, or near it: the size is a factor.
    """
    far = rng.laplace(scale=1.0 / np.sqrt(2.0), size=individuals.shape)
    return population.mean + fault.size * population.sd * far


NUISANCE = Nuisance(
    id="laplace_population",
    sentence="parameters that scatter as Laplace's law",
    finding="",
    low=0.8,
    high=1.2,
    trials=2,
    people=_people,
)
