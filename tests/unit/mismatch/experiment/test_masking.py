"""What a protocol can show of an effect that stands alone."""

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.experiment.masking import tabulate_masking


def test_a_law_of_flow_vanishes_under_one_load_and_not_under_several(draw_campaign):
    campaign = draw_campaign(2, 0.0)
    gains = []
    for chosen in (slice(0, None, 3), slice(None)):  # one level of the load, all three
        problem, fit = pose_problem(campaign.isel(trial=chosen))
        base = Candidate(problem.base, fit, fit.log_evidence)
        laws = ("yield_threshold", "stress_nonlinear_flow")
        pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id in laws]
        masking = tabulate_masking(collect_columns(problem, base, pieces), problem, base)
        assert set(masking["effect"].values) == set(laws)
        gains.append(masking["expected_gain"])
    assert gains[0].max() < 0.5  # a free law of flow keeps a trace
    assert gains[1].sel(effect="yield_threshold") > 1.0
    assert gains[1].sel(effect="stress_nonlinear_flow") > 10.0
