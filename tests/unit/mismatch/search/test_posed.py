"""What a survey under another measurement takes over from the first."""

from types import SimpleNamespace

import pytest
import xarray as xr

from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mismatch import posed
from softfinger.mismatch.posed import Survey, choose_reading


@pytest.fixture
def bare(named):
    """A survey that ranked nothing, beside what led before."""
    empty = Survey(catalogue=([], {}), columns=None, alarms=None, needed=5.0, ranked=([], ["s"]))
    return empty, named.problem, named.search.base, named.search.best


def test_a_leader_that_the_second_survey_missed_leads_again(bare):
    survey, problem, base, leader = bare
    joined = survey.join_leaders(problem, base, [leader])
    (again,), scores = joined.ranked
    assert again.model is leader.model
    assert again.log_evidence == pytest.approx(leader.log_evidence, abs=0.5)
    assert scores == ["s"]


def test_of_two_fits_of_a_model_the_better_competes(bare):
    survey, problem, base, leader = bare
    for ahead, kept in ((-5.0, leader.fit), (1e6, "fit")):
        ranked = leader._replace(fit="fit", log_evidence=leader.log_evidence + ahead)
        other = base._replace(log_evidence=base.log_evidence - 1.0)
        joined = survey._replace(ranked=([other, ranked], [])).join_leaders(problem, base, [leader])
        first, last = joined.ranked[0]
        assert last is other
        assert (first is ranked) == (kept == "fit")


@pytest.mark.parametrize(("more", "held"), [(0.9, False), (1.1, True)])
def test_a_log_is_read_otherwise_from_a_nat_on(monkeypatch, more, held):
    monkeypatch.setattr(
        posed, "mend_recordings", lambda _, mended: xr.Dataset({"held": mended.ramps_held})
    )
    monkeypatch.setattr(posed, "weigh_log", lambda *_: more)
    survey = SimpleNamespace(ranked=([], []), needed=5.0)
    before = SimpleNamespace(
        plain=None, base=None, survey=survey, mended=MeasurementEntry(), known={}
    )
    after = choose_reading(xr.Dataset(), before, lambda mended, known: mended)
    assert (after is not before) == held
    assert not held or after.ramps_held
