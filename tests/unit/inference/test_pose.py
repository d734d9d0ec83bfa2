"""Where a campaign's fits begin."""

from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import _find_start


@pytest.mark.parametrize(("most", "part"), [(2.0, 1.0), (0.6, 0.5), (0.0, 0.0)])
def test_a_repaired_model_starts_where_the_trials_have_a_motion(most, part):
    """Only its effects' amplitudes become smaller."""

    def linearise(model, own, shared):
        return np.array([np.nan if shared[0] > most else 1.0])

    model = SimpleNamespace(amplitudes=np.array([True, False]), low=-np.inf, high=np.inf)
    start = _find_start(SimpleNamespace(linearise=linearise), model, None, np.array([1.0, 3.0]))
    assert start.tolist() == [part, 3.0]
