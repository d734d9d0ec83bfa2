import numpy as np
import pytest

from softfinger.faults import ListedFault
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mismatch import diagnose
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.verdict.conclude import conclude
from softfinger.mismatch.verdict.sufferings import doubt_patience

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}


def quiet(items, _):
    return items


def test_a_clean_campaign_is_adequate(clean):
    verdict = clean.verdict
    assert verdict.decision == "adequate"
    assert verdict.effects == []
    assert verdict.residual_rms_rad.final == pytest.approx(0.002, rel=0.1)
    assert {"actuator_lag", "joint_coupling", "gravity"} & set(verdict.not_testable)


def test_a_second_retardation_is_named_with_its_size(named):
    verdict = named.verdict
    assert verdict.decision == "named"
    assert [effect.id for effect in verdict.effects] == ["second_retardation"]
    found = verdict.effects[0]
    assert found.joints == [1]
    time, share = (found.parameters[name] for name in ("retardation_time_s", "compliance_share_1"))
    assert abs(time.mean - 1.5) < 4 * time.sd
    assert abs(share.mean - 0.15) < 4 * share.sd
    assert "second retardation was left out" in found.statement
    assert verdict.elpd.difference > 3 * verdict.elpd.se > 0
    assert verdict.residual_rms_rad.final < verdict.residual_rms_rad.baseline


def test_the_same_seed_gives_the_same_verdict(named, draw_campaign):
    again = diagnose(draw_campaign(1, 0.15), CONFIG, 5, quiet)
    assert again.verdict == named.verdict


def test_masking_speaks_of_every_effect_the_campaign_allows(clean):
    pieces, refused = list_pieces(clean.problem.setting)
    table = clean.masking
    assert set(table["effect"].values) == {piece.effect.id for piece in pieces}
    assert not set(table["effect"].values) & set(refused)
    assert ((table["share_left"] >= 0) & (table["share_left"] <= 1 + 1e-9)).all()
    np.testing.assert_allclose(np.diag(table["likeness"]), 1.0, atol=1e-6)


def test_tangents_are_the_slopes_of_the_slots(clean):
    setting = clean.problem.setting
    for piece in list_pieces(setting)[0]:
        model = EffectModel(setting, (piece,))
        shared = model.place_start(0, model.list_starts(0)[0]) + 0.1 * model.shared_prior[1]
        shared = np.clip(shared, model.low, model.high - 1e-3)
        for k, tangent in enumerate(model.fill_tangents(shared)):
            step = np.zeros(len(shared))
            step[k] = 1e-3 * model.shared_prior[1][k]
            up, down = model.fill_slots(shared + step), model.fill_slots(shared - step)
            for slope, high, low in zip(tangent, up, down, strict=True):
                expected = (high - low) / (2 * step[k])
                np.testing.assert_allclose(slope, expected, rtol=2e-2, atol=1e-6)


def test_settings_are_checked(draw_campaign):
    with pytest.raises(ListedFault, match="false_alarm_probability"):
        diagnose(draw_campaign(1, 0.0), {**CONFIG, "false_alarm_probability": 2.0}, 5, quiet)


def test_what_an_ambiguous_set_holds_is_not_called_untestable(named, recorded):
    search, posterior = named.search, named.posterior
    first = frozenset({"second_retardation"})
    other = next(c for c in search.candidates if c.fit is not None and not first & c.model.ids)
    second = other.model.ids
    unsure = posterior._replace(
        sets={first: 0.6, second: 0.4},
        inclusion={name: 0.6 if name in first else 0.4 for name in first | second},
        best={first: search.best, second: other},
    )
    hidden = {*first, *second, "gravity"}
    verdict = conclude(named.problem, search, unsure, named.findings, recorded, hidden, {}, 5.0)
    assert verdict.decision == "ambiguous"
    assert verdict.not_testable == ["gravity"]


def test_a_verdict_tells_what_its_effects_explain_and_what_was_not_tried(named):
    first = named.verdict.explained[0]
    assert first.effects == ["second_retardation"]
    assert first.share > 0.8
    assert not first.amplitudes_cover_zero
    reasons = {one.id: one.reason for one in named.verdict.not_tried}
    assert reasons
    assert all(reasons.values())
    assert set(reasons) <= set(named.verdict.not_testable)


def test_a_search_that_has_no_time_ends_with_the_best_so_far_and_warns(recorded):
    hurried = diagnose(recorded, {**CONFIG, "longest_search_s": 1e-9}, 5, lambda items, _: items)
    assert hurried.cut_short
    assert {e.id for e in hurried.verdict.effects} == {"second_retardation"}
    (warned,) = doubt_patience(hurried.cut_short, 1e-9)
    assert "longest_search_s" in warned.statement
    assert doubt_patience(False, 600.0) == []
