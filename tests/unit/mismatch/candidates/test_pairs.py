import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.candidates.columns import collect_columns, join_blocks
from softfinger.mismatch.candidates.pairs import rank_pairs, rank_triples
from softfinger.mismatch.candidates.rank import list_pieces


def quiet(items, _):
    return items


@pytest.fixture(scope="module")
def posed(draw_campaign):
    problem, fit = pose_problem(draw_campaign(1, 0.15))
    base = Candidate(problem.base, fit, fit.log_evidence)
    wanted = ("second_retardation", "lens_distortion", "strain_stiffening")
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id in wanted]
    return problem, base, collect_columns(problem, base, pieces)


def test_a_pair_is_linearised_as_the_model_of_both_at_its_null(posed):
    problem, base, columns = posed
    lens = next(b for b in columns.blocks if b.model.pieces[-1].form.name == "cubic")
    stiff = next(b for b in columns.blocks if b.model.pieces[-1].effect.id == "strain_stiffening")
    pair = join_blocks(lens, stiff)
    null = pair.shared.copy()
    null[pair.new] = 0.0
    pair = pair._replace(shared=null)
    expected = problem.linearise(pair.model, base.fit.own, null)
    size = np.sqrt(np.einsum("tii->ti", expected).max(axis=0))
    np.testing.assert_allclose(
        columns.linearise(pair) / np.outer(size, size),
        expected / np.outer(size, size),
        atol=1e-5,
    )


def test_the_best_pair_holds_the_true_effect_and_known_pairs_are_not_fitted_again(posed):
    problem, base, columns = posed
    asked = base.log_evidence
    best = rank_pairs(problem, base, columns, [], asked, quiet)[0]
    assert "second_retardation" in best.model.ids
    assert len(best.model.ids) == 2
    fitted = rank_pairs(problem, base, columns, [best], asked, quiet)
    assert fitted
    assert best.model.ids not in {candidate.model.ids for candidate in fitted}


def test_a_triple_is_a_pair_with_a_third_effect(posed):
    problem, base, columns = posed
    (only,) = {c.model.ids for c in rank_triples(problem, base, columns, [], -np.inf, quiet)}
    assert only == {"second_retardation", "lens_distortion", "strain_stiffening"}


def test_what_alters_trials_parameters_alone_looks_exactly_as_they_do(draw_campaign):
    """Slopes beside the null differed from theirs by 1 %: scores fell behind fits by 6 nats."""
    problem, fit = pose_problem(draw_campaign(1, 0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "fatigue_softening"]
    columns = collect_columns(problem, base, pieces)
    d, gram = columns.own, columns.gram[:, :-1, :-1]
    cross = gram[:, :d, d:]
    left = gram[:, d:, d:] - cross.transpose(0, 2, 1) @ np.linalg.solve(gram[:, :d, :d], cross)
    share = np.einsum("tcc->tc", left) / np.maximum(np.einsum("tcc->tc", gram[:, d:, d:]), 1e-300)
    assert columns.blocks
    assert np.abs(share).max() < 1e-10
