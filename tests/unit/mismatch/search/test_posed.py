"""What a survey under another measurement takes over from the first."""

import pytest

from softfinger.mismatch.posed import Survey


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
