"""What a protocol can show.

Each effect's signal, what the base model absorbs of it, and likeness.

The signal of an effect at a given strength is its change of all recorded angles, in units of their
noise. What is left of it after each trial's own parameters and their population mean have adapted
is what a diagnosis can see; the share is the masking index.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.mismatch.candidates.columns import ScoreColumns
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.calibrate import project_columns_array


def tabulate_masking(columns: ScoreColumns, problem: Problem, base: Candidate) -> xr.Dataset:
    """Tabulate every effect under one protocol.

    Parameters
    ----------
    columns
        Of `collect_columns`.
    problem, base
        Recordings (or a design without data) and the base model fitted to them.

    Returns
    -------
    Dataset
        signal (effect) [noise sd], Euclidean; share_left (effect), 0 = absorbed whole;
        expected_gain (effect) [nats]; bias (effect, joint, parameter), what ignoring the effect
        adds to the population's means; likeness (effect, other_effect), cosine of what is left.
    """
    d = len(base.fit.omega)
    precision = problem.build_prior(base.model).precision[:d]
    gram = columns.bare
    left, shift = project_columns_array(gram, d, precision, base.fit.omega)
    total = gram[:, d:, d:].sum(axis=0)
    chosen: dict[str, tuple[float, NDArray]] = {}
    for label, first, count in zip(columns.label, columns.first, columns.count, strict=True):
        direction = np.zeros(len(columns.sd))
        part = slice(first, first + count)
        direction[part] = DECISIONS.strength * columns.sd[part]
        size = float(direction @ left @ direction)
        if label not in chosen or size > chosen[label][0]:
            chosen[label] = size, direction
    names = list(chosen)
    directions = np.array([chosen[name][1] for name in names])
    inner = directions @ left @ directions.T
    size = np.sqrt(np.maximum(np.diag(inner), 1e-30))
    signal = np.sqrt(np.einsum("ec,cd,ed->e", directions, total, directions))
    bias = (directions @ shift.T).reshape(len(names), -1, OWN)
    return xr.Dataset(
        {
            "signal": ("effect", signal),
            "share_left": ("effect", np.where(signal > 0, size / np.maximum(signal, 1e-30), 0.0)),
            "expected_gain": ("effect", 0.5 * (size**2 - np.log1p(size**2))),
            "bias": (("effect", "joint", "parameter"), bias),
            "likeness": (("effect", "other_effect"), inner / np.outer(size, size)),
        },
        coords={
            "effect": names,
            "other_effect": names,
            "joint": np.arange(1, bias.shape[1] + 1),
            "parameter": list(LOG_PARAMETERS),
        },
    )


def list_invisible(table: xr.Dataset, needed: float) -> list[str]:
    """Effects that could not gain `needed` nats."""
    hidden = table["expected_gain"].values < needed
    return [str(name) for name in table["effect"].values[hidden]]
