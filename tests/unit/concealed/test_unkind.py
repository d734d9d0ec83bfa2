"""Campaigns recorded unkindly: balanced, and in pairs that differ by nuisances alone."""

from collections import Counter
from dataclasses import replace

import pytest

from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.noise import NOISE_KINDS
from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.proof import draw_proof
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.unkind import CLEAN_S, draw_clean, draw_twins


@pytest.fixture(scope="module")
def clean():
    return draw_clean(3, 342)


def test_clean_campaigns_have_every_condition_equally_often(clean):
    assert len(clean) >= 300
    assert not any(spec.effects for spec in clean)
    single = Counter(spec.nuisances for spec in clean if len(spec.nuisances) == 1)
    assert single == {(name,): 18 for name in NUISANCES}
    several = [spec.nuisances for spec in clean if len(spec.nuisances) > 1]
    assert len(several) == 36
    assert len(set(several)) > 25
    assert {spec.protocol for spec in clean} == set(PROTOCOLS)
    assert {spec.noise for spec in clean} == set(NOISE_KINDS)
    assert all(spec.duration_s == CLEAN_S and spec.trials <= 12 for spec in clean)
    assert any(spec.trials == 1 for spec in clean)


def test_a_nuisance_gets_the_trials_that_it_needs(clean):
    for spec in clean:
        assert spec.trials >= max(NUISANCES[name].trials for name in spec.nuisances)


@pytest.mark.parametrize("catalogue", CATALOGUES)
def test_twins_differ_by_their_nuisances_alone(catalogue):
    suite = draw_twins(3, 60, catalogue)
    assert len(suite) == 120
    for kind, unkind in zip(suite[::2], suite[1::2], strict=True):
        assert replace(unkind, nuisances=()) == kind
        assert len(unkind.nuisances) in (1, 2, 3, 4)
        assert kind.trials >= EFFECTS[kind.effects[0]].trials
    assert {spec.effects[0] for spec in suite} == set(CATALOGUES[catalogue])
    assert len({spec.seed for spec in suite}) == 60
    alone = {spec.nuisances[0] for spec in suite if len(spec.nuisances) == 1}
    assert len(alone) >= 14


def test_what_comes_later_leaves_the_rest_of_a_proof_as_it_is():
    short = draw_proof(5, campaigns=24, filmed=1, longest=20)
    proof = draw_proof(5, campaigns=24, filmed=1, longest=20, clean=19, twins=4)
    assert proof[:26] == short
    assert len(proof) == 26 + 19 + 8
    assert len({spec.nuisances for spec in proof[26:45]}) == 19
