from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import Piece
from softfinger.mechanics.effects.model_file import (
    build_model,
    describe_model,
    read_model_file,
    write_model_file,
)
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.law_size import list_sizes, resize_laws
from softfinger.mismatch.candidates.linearised import Linearised
from softfinger.mismatch.candidates.rank import choose_starts
from softfinger.mismatch.priors import PRIORS


@pytest.fixture(scope="module")
def posed(draw_campaign):
    problem, fit = pose_problem(draw_campaign(4, 0.0))
    return problem, Candidate(problem.base, fit, fit.log_evidence)


def find_pieces(problem, effect="stress_nonlinear_flow"):
    found = list_effects()[effect]
    return {form.name: Piece(found, form, ()) for form in found.list_forms(problem.setting)}


@pytest.mark.parametrize(("share", "size"), [(1.0, 1.0), (0.01, 0.0625)])
def test_a_slight_law_has_a_small_size(posed, share, size):
    problem, base = posed
    model = problem.base.extend(find_pieces(problem)["free"])
    shared = share * model.shared_prior[1]
    gram = problem.linearise(model, base.fit.own, shared)
    gram[:, -1] = gram[:, :, -1] = 0.0  # the recordings are what this law makes them
    there = Linearised(gram, base.fit.own, shared, base.fit.omega)
    resized = resize_laws(problem, model, there)
    assert resized.pieces[0].size == size
    np.testing.assert_allclose(resized.shared_prior[1], size * model.shared_prior[1])


def test_a_textbook_form_has_one_size(posed):
    problem, _ = posed
    forms = find_pieces(problem)
    textbook = next(piece for name, piece in forms.items() if not piece.form.is_free)
    assert len(list(list_sizes(problem.base.extend(textbook), 0))) == 1
    sized = list_sizes(problem.base.extend(forms["free"]), 0)
    assert [model.pieces[0].size for model in sized] == list(PRIORS.law_sizes)


def test_a_form_is_scored_once_at_its_best_size(posed):
    problem, base = posed
    columns = collect_columns(problem, base, [find_pieces(problem)["free"]])
    scored = choose_starts(problem, base, columns)
    assert len(scored) == 1
    assert scored[0][1].model.pieces[-1].size == min(PRIORS.law_sizes)  # nothing is there


def test_a_model_file_keeps_the_size_of_a_law(posed, tmp_path):
    problem, _ = posed
    piece = replace(find_pieces(problem)["free"], size=0.25)
    model = problem.base.extend(piece)
    count = len(model.entries)
    content = describe_model(model, np.zeros(count), 1e-4 * np.eye(count), None)
    write_model_file(content, tmp_path / "model.yaml")
    again = build_model(read_model_file(tmp_path / "model.yaml"), problem.setting, priors=False)
    np.testing.assert_allclose(again.shared_prior, model.shared_prior)
