"""A concealed campaign's trials, near the paper's."""

from dataclasses import dataclass

import numpy as np

from softfinger.concealed.arrays import Array

PARAMETERS = ("k_v", "c_v", "c_p", "q_ini")

# The paper's table (μ, σ of the logarithms); joint 3's c_p log-normal(3.3, 0.9), because no motion
# follows from the printed 3.23; q_ini is not printed.
PAPER_MEAN = np.array(
    [
        [-2.4441, -2.2986, -1.8800],
        [-3.6635, -3.6476, -3.8777],
        [2.8538, 3.1129, 3.3],
        [0.02, 0.02, 0.02],
    ]
)
PAPER_SD = np.array(
    [
        [0.1973, 0.2238, 0.3957],
        [0.5232, 0.4838, 0.8223],
        [0.7011, 0.8496, 0.9],
        [0.01, 0.01, 0.01],
    ]
)


@dataclass(frozen=True)
class Population:
    """Mean and sd of the parameters, independent.

    They are (parameter, joint), of log k_v, log c_v, log c_p and of q_ini.
    """

    mean: Array
    sd: Array


def draw_population(rng: np.random.Generator) -> Population:
    """Draw a new population near the paper's."""
    shift = rng.normal(0.0, 1.0, PAPER_MEAN.shape) * np.array([[0.12], [0.12], [0.2], [0.004]])
    return Population(PAPER_MEAN + shift, PAPER_SD * np.exp(rng.normal(0.0, 0.15, PAPER_SD.shape)))


def draw_individuals(population: Population, trials: int, rng: np.random.Generator) -> Array:
    """Draw the parameters of every trial.

    They are (trial, parameter, joint): log k_v, log c_v, log c_p, q_ini.
    """
    return population.mean + population.sd * rng.normal(size=(trials, *population.mean.shape))


def to_parameters(individual: Array) -> Array:
    """Turn logarithms into k_v, c_v, c_p, q_ini.

    The array is (…, parameter, joint).
    """
    return np.concatenate([np.exp(individual[..., :3, :]), individual[..., 3:, :]], axis=-2)
