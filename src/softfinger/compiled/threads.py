"""Parts of the trials, run side by side in threads."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise

import numpy as np
from numba import config
from numpy.typing import NDArray

_PARTS = 2  # for each thread, so that one with slow trials does not hold up the rest

Arrays = tuple[NDArray[np.float64], ...]


def run_side_by_side(run: Callable[[slice], Arrays], trials: int) -> Arrays:
    """Run parts of the trials in threads.

    There are as many as numba uses; what they return is joined.

    Parameters
    ----------
    run
        From some trials to arrays whose first axis they are. As each trial is computed for itself,
        the result does not depend on how they are cut.
    """
    threads = config.NUMBA_NUM_THREADS
    parts = min(_PARTS * threads, trials)
    if threads == 1 or parts < 2:
        return run(slice(0, trials))
    edge = np.linspace(0, trials, parts + 1).astype(int)
    cuts = (slice(*ends) for ends in pairwise(edge))
    found = list(_open_pool(os.getpid()).map(run, cuts))
    return tuple(np.concatenate(arrays) for arrays in zip(*found, strict=True))


@cache
def _open_pool(_process: int) -> ThreadPoolExecutor:
    """Threads that wait for work, one pool per process."""
    return ThreadPoolExecutor(config.NUMBA_NUM_THREADS)
