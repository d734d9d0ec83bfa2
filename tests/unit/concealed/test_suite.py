import hashlib
import json
from collections import Counter

import pytest

from softfinger.concealed.effects import CATALOGUES, OUTSIDERS
from softfinger.concealed.noise import NOISE_KINDS
from softfinger.concealed.proof import draw_proof
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.suite import PLAIN, draw_catalogue, draw_suite

LISTED, OUTSIDE = CATALOGUES["first"], OUTSIDERS["first"]


@pytest.fixture(scope="module")
def long_suite():
    return draw_suite(7, 200)


def _is_clean(spec):
    return not spec.effects or spec.quantiles[0] < 0.0


def test_the_long_suite_is_balanced(long_suite):
    assert len(long_suite) == 200
    clean = [s for s in long_suite if _is_clean(s)]
    assert len(clean) >= 50
    assert {s.noise for s in clean} == set(NOISE_KINDS)
    assert sum(bool(s.effects) for s in clean) == 2
    assert {s.trials for s in long_suite if not s.filmed} >= {1, 10, 40, 100}
    single = Counter(s.effects[0] for s in long_suite if len(s.effects) == 1 and not _is_clean(s))
    assert set(single) == set(LISTED) | set(OUTSIDE)
    listed = [single[name] for name in LISTED]
    assert max(listed) - min(listed) <= 1
    assert min(single[name] for name in LISTED) >= 4
    assert sum(len(s.effects) == 2 for s in long_suite) >= 20
    protocols = Counter(s.protocol for s in long_suite)
    assert set(protocols) == set(PROTOCOLS)
    assert max(protocols.values()) - min(protocols.values()) <= 1


def test_strengths_of_an_effect_are_spread(long_suite):
    for name in LISTED:
        places = sorted(
            s.quantiles[0] for s in long_suite if s.effects == (name,) and not _is_clean(s)
        )
        for k, place in enumerate(places):
            assert k / len(places) <= place <= (k + 1) / len(places)


def test_filmed_cases_are_short_and_show_what_a_camera_can(long_suite):
    filmed = [s for s in long_suite if s.filmed]
    assert len(filmed) == 10
    for spec in filmed:
        assert spec.trials <= 10
        assert not any(EFFECTS[name].record for name in spec.effects)


def test_effects_get_joints_and_trials_that_can_show_them(long_suite):
    assert any(len(s.joints[0]) == 1 for s in long_suite if s.effects)
    for spec in long_suite:
        assert len(spec.effects) == len(spec.joints) == len(spec.quantiles)
        for name, joints in zip(spec.effects, spec.joints, strict=True):
            effect = EFFECTS[name]
            assert spec.trials >= effect.trials
            expected = {"chain": (0,), "first": (1,), "one": (1,), "pair": (2,), "any": (1, 3)}
            assert len(joints) in expected[effect.joints]


@pytest.mark.parametrize("n", [24, 31])
def test_short_suites_have_a_quarter_of_clean_ones_and_a_film(n):
    suite = draw_suite(3, n)
    assert sum(_is_clean(s) for s in suite) >= n / 4
    assert sum(s.filmed for s in suite) == 1
    assert any(len(s.effects) == 2 for s in suite)
    assert any(name in OUTSIDE for s in suite for name in s.effects)


def test_a_seed_gives_one_suite_and_another_seed_another():
    assert draw_suite(0, 24) == draw_suite(0, 24)
    assert draw_suite(0, 24) != draw_suite(1, 24)
    assert len({s.seed for s in draw_suite(0, 24)}) == 24
    json.dumps([s.to_json() for s in draw_suite(0, 24)])


def test_no_campaign_is_longer_than_the_longest_and_the_papers_case_comes_last():
    proof = draw_proof(5, campaigns=24, filmed=1, longest=20)
    assert len(proof) == 26
    assert max(spec.trials for spec in proof) == 20
    assert [spec.effects for spec in proof[24:]] == [("moment_arm",), ("moment_arm",)]
    assert [spec.protocol for spec in proof[24:]] == ["levels", "single_step"]
    assert all(spec.strengths == (1.0,) for spec in proof[24:])


def test_the_catalogues_suite_has_every_effect_under_every_protocol_plainly_visible():
    suite = draw_catalogue(5, 92, longest=40)
    singles = Counter((s.effects[0], s.protocol) for s in suite if len(s.effects) == 1)
    assert singles == Counter({(name, protocol): 1 for name in LISTED for protocol in PROTOCOLS})
    pairs = [s for s in suite if len(s.effects) == 2]
    assert len({s.effects for s in pairs}) == len(pairs) == 24
    assert {s.protocol for s in pairs} == set(PROTOCOLS)
    assert all(PLAIN <= place <= 1.0 for s in suite for place in s.quantiles)
    assert all(s.even for s in pairs)
    assert draw_proof(5, campaigns=92, filmed=0, longest=40, kind="catalogue")[:92] == suite


DRAWN = ("seed", "effects", "joints", "quantiles", "protocol", "trials", "noise", "filmed", "even")


def _digest(suite):
    rows = [{key: spec.to_json()[key] for key in (*DRAWN, "strengths")} for spec in suite]
    return hashlib.sha256(json.dumps(rows).encode()).hexdigest()[:16]


def test_draws_of_earlier_versions_are_what_they_were():
    assert _digest(draw_suite(1, 24)) == "150646448f0c8e08"
    assert _digest(draw_suite(7, 200)) == "fd4ab57a046de29b"
    assert _digest(draw_catalogue(5, 92, longest=40)) == "01ddea8e1a247461"
    proof = draw_proof(5, campaigns=24, filmed=1, longest=20)
    assert _digest(proof) == "882fe2d8b6a0daee"
    assert not any(spec.nuisances for spec in proof)
