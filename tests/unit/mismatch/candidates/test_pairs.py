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


def test_a_pair_is_linearised_as_the_model_of_both_at_its_start(posed):
    problem, base, columns = posed
    lens = next(b for b in columns.blocks if b.model.pieces[-1].form.name == "cubic")
    stiff = next(b for b in columns.blocks if b.model.pieces[-1].effect.id == "strain_stiffening")
    pair = join_blocks(lens, stiff)
    expected = problem.linearise(pair.model, base.fit.own, pair.shared)
    size = np.sqrt(np.einsum("tii->ti", expected).max(axis=0))
    np.testing.assert_allclose(
        columns.linearise(pair) / np.outer(size, size),
        expected / np.outer(size, size),
        atol=2e-2,
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
