"""Noise that lasts longer than it seemed, as a rival of effects."""

from dataclasses import replace

import pytest

from softfinger.mismatch.columns import collect_columns
from softfinger.mismatch.problem import Candidate, pose_problem
from softfinger.mismatch.rank import list_pieces, rank_pieces
from softfinger.mismatch.rival_noise import may_be_noise
from softfinger.mismatch.search import Search
from softfinger.mismatch.trials import prepare_trials

NEEDED = 5.0
ASKED = ("second_retardation", "fractional_creep")


@pytest.fixture(scope="module", params=[0.0, 0.15], ids=["clean", "second retardation"])
def found(request, draw_campaign):
    """The best effect under noise that is taken to last shorter than it does."""
    angles = draw_campaign(7, request.param, rho=0.97)
    problem, fit = pose_problem(angles)
    short = problem.noise.assign(
        noise_sd=0.5 * problem.noise["noise_sd"], noise_autocorrelation=("joint", [0.6])
    )
    problem = replace(problem, noise=short, trials=prepare_trials(angles, short)[0])
    fit = problem.fit(problem.base, (fit.own, fit.shared, fit.omega))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id in ASKED]
    columns = collect_columns(problem, base, pieces)
    best = rank_pieces(problem, base, columns, lambda items, _: items)[0][0]
    gain = best.log_evidence - base.log_evidence
    return request.param, problem, Search(base, [best], [], best, gain, {}, []), angles


def test_what_lasting_noise_says_as_well_is_doubted_and_nothing_else(found):
    share, problem, search, angles = found
    assert search.first_gain > NEEDED
    assert may_be_noise(problem, search, angles, NEEDED) == (share == 0.0)
