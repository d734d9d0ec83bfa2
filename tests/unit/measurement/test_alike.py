import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.measurement.alike import find_usual_excess_array

EXCESS = st.lists(st.floats(0.0, 100.0, width=16), min_size=1, max_size=8)


@pytest.mark.parametrize(("trials", "judged"), [(2, False), (3, True)])
def test_where_few_frames_compare_none_is_an_outlier(trials, judged):
    usual = find_usual_excess_array(np.full((trials, 1), 3.0), np.full((trials, 1), 0.1))
    assert (usual == (3.0 if judged else np.inf)).all()


def test_frames_sooner_and_later_compare_where_few_are_alike():
    """A misfit that decays is usual; the first frames have none before them."""
    since, excess = np.geomspace(0.1, 5.0, 9)[None], np.geomspace(1000.0, 1.0, 9)[None]
    usual = find_usual_excess_array(excess, since)[0]
    assert np.isinf(usual[[0, 1, 2, 6, 7, 8]]).all()
    assert (usual[3:6] > excess[0, 3:6]).all()
    assert (usual[3:6] < excess[0, 1:4]).all()


def test_the_first_frames_of_a_long_trial_are_not_compared_with_later_ones():
    """Frames each second of hours, and each tenth of the first: a misfit that rings is no error."""
    since = np.concatenate([np.arange(0.0, 3.0, 0.1), np.arange(3.0, 9000.0, 1.0)])[None]
    excess = np.where(since < 0.5, 100.0, 1.0)
    assert (find_usual_excess_array(excess, since)[0, :5] == 1.0).all()
    assert np.isinf(find_usual_excess_array(excess, since, 0.1)[0, :2]).all()


def test_a_gross_error_is_not_compared_with_what_it_raises():
    """A single trial: beside the error are the frames that are most alike."""
    excess = np.array([[1.0, 1.0, 40.0, 100.0, 40.0, 1.0, 1.0]])
    usual = find_usual_excess_array(excess, np.linspace(0.20, 0.22, 7)[None])
    assert usual[0, 3] == 1.0


@given(st.lists(EXCESS, min_size=1, max_size=4))
def test_it_is_the_median_of_the_frames_that_are_not_beside(rows):
    excess = np.full((len(rows), 8), np.nan)
    for row, values in zip(excess, rows, strict=True):
        row[: len(values)] = values
    usual = find_usual_excess_array(excess, np.ones(excess.shape))
    for trial, frame in zip(*np.nonzero(np.isfinite(excess)), strict=True):
        others = excess.copy()
        others[trial, max(frame - 1, 0) : frame + 2] = np.nan
        left = others[np.isfinite(others)]
        expected = max(np.median(left), 1.0) if len(left) > 1 else np.inf
        assert usual[trial, frame] == expected
