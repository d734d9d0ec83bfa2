import numpy as np

from softfinger.mismatch.candidates import columns
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces


def test_shifts_of_parameters_move_the_angles_as_a_simulation_does(named, monkeypatch):
    """On top of an effect, for all forms that shift a trial's own parameters."""
    problem, best = named.problem, named.search.best
    compared = []

    def compare(model, slope, null, new):
        found = shift(model, slope, null, new)
        expected = problem.simulate(model, best.fit.own, null, only=new)[1]
        size = np.abs(expected).max()
        np.testing.assert_allclose(found, expected, atol=1e-4 * size)
        compared.append(model.pieces[-1].effect.id)
        return found

    shift = columns._shift_parameters
    monkeypatch.setattr(columns, "_shift_parameters", compare)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id not in best.model.ids]
    collected = collect_columns(problem, best, pieces)
    assert {"fatigue_softening", "session_jump"} <= set(compared)
    assert set(compared) < set(collected.label)
