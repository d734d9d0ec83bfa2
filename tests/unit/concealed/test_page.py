"""The page of the proof: every number that it shows is there, and nothing is shown that is not."""

import json

import numpy as np
import pytest
import xarray as xr

from softfinger.concealed.score import score
from softfinger.concealed.table import describe_answer, tabulate_cases, tabulate_measured
from softfinger.report.concealed import Proof, render_proof
from softfinger.report.concealed_protocols import build_conditions, build_protocols
from softfinger.stages.score import _score_rivals
from softfinger.summary.buried import average_residual


def _effect(name, **more):
    return {"id": name, "joints": [2], "probability": 0.97, "parameters": {}, **more}


def _answer(decision, *names, equivalent=(), reason=None):
    verdict = {
        "decision": decision,
        "effects": [_effect(name) for name in names],
        "equivalent": [list(group) for group in equivalent],
        "location": None,
        "elpd": None,
    }
    return {"verdict": verdict, "reason": reason, "seconds": 31.0, "cpu_seconds": 12.5}


def _truth(*names, gain=50.0, place=0.5):
    told = {"level": "within_trial", "covariate": None, "joints": [2], "parameters": {}}
    effects = [{"id": n, "listed": n != "joint_play", "gain_nats": gain, **told} for n in names]
    return {
        "case": {
            "protocol": "single_step",
            "trials": 10,
            "noise": "ar_0.9",
            "filmed": False,
            "quantiles": [place],
        },
        "effects": effects,
        "gain_nats": gain if names else 0.0,
        "elpd_difference": None,
        "values": 1000,
        "misfit": {"base": 1.5, "true": 1.0},
        "window_s": None,
        "population": {"mean": [[0.0] * 3]},
    }


NAMES = ["aaaa000001", "bbbb000002", "cccc000003", "dddd000004"]
TRUTHS = [_truth("gravity"), _truth(place=-1.0), _truth("joint_play"), _truth("inertia")]
ANSWERS = [
    _answer("named", "gravity"),
    _answer("adequate"),
    _answer("unlisted"),
    _answer("crashed", reason="ValueError: <no>"),
]
LIMITS = [
    {"gravity": {"moment_arm": 0.4, "inertia": 31.0}},
    {},
    {"joint_play": {"inertia": 9.0}},
    {"inertia": {"gravity": 25.0}},
]


@pytest.fixture
def scored():
    verdicts = [answer["verdict"] for answer in ANSWERS]
    found = score(verdicts, TRUTHS, LIMITS, seconds=[31.0] * 4)
    cost = {"seconds_median": 31.0, "seconds_most": 31.0, "cpu_seconds_median": 12.5}
    return found.assign_attrs(source="synthetic", chance=0.25, **cost)


@pytest.fixture
def repair():
    rng = np.random.default_rng(1)
    shape = (2, 5, 3, 7)
    dims = ("trial", "joint", "bin")
    return xr.Dataset(
        {
            "recorded_angle": (dims, rng.normal(size=shape[1:])),
            "fitted_angle": (("model", *dims), rng.normal(size=shape)),
            "bin_noise_sd": (dims, np.ones(shape[1:])),
            "time": (("trial", "bin"), np.tile(np.arange(7.0), (5, 1))),
        },
        coords={"model": ["base", "final"], "joint": [1, 2, 3]},
        attrs={"source": "synthetic"},
    )


def _render(scored, **changes):
    content = {
        "seed": 7,
        "score": scored,
        "rivals": {"per-trial BIC": scored},
        "cases": tabulate_cases(NAMES, TRUTHS, ANSWERS, LIMITS),
        "seals": [(name, "f00d" * 16, "beef" * 16) for name in NAMES],
        "measured": "Skipped: there are none.",
        "buried": None,
    }
    return render_proof(Proof(**content | changes))


def test_one_of_hundreds_does_not_read_as_none(scored):
    share = scored["share"].copy()
    share.loc[{"statistic": "crashed"}] = 1 / 202
    assert "0.5 %" not in _render(scored)
    assert "0.5 %" in _render(scored.assign(share=share))


def test_the_page_shows_scores_digests_and_crashes(scored, repair):
    page = _render(scored, buried=("aaaa000001", "It concealed gravity.", average_residual(repair)))
    assert "The proof, seed 7: 4 concealed campaigns" in page
    assert page.count("f00d" * 16) == 4
    assert page.count("beef" * 16) == 4
    assert "ValueError: &lt;no&gt;" in page
    assert "per-trial BIC" in page
    assert "It concealed gravity." in page
    assert "Skipped: there are none." in page
    assert "25 %" in page  # chance
    assert "moment_arm 0.4" in page


def test_rivals_may_be_asked_about_some_of_the_campaigns(scored, tmp_path):
    asked = [NAMES[1], NAMES[0]]
    for name, answer in zip(asked, (ANSWERS[1], ANSWERS[0]), strict=True):
        said = dict.fromkeys(("loo", "bic"), answer["verdict"])
        (tmp_path / f"{name}.json").write_text(json.dumps(said))
    paths = [tmp_path / f"{name}.json" for name in asked]
    rivals = _score_rivals(paths, NAMES, TRUTHS, LIMITS)
    assert rivals["per-trial BIC"]["gain"].values.tolist() == [0.0, 50.0]
    assert rivals["per-trial BIC"]["right"].values.all()
    assert "on 2 of the campaigns" in _render(scored, rivals=rivals)
    assert "on the same campaigns" in _render(scored)
    assert "Beside it two ways" not in _render(scored, rivals=_score_rivals([], NAMES, TRUTHS, []))


def test_what_the_oracle_could_not_name_either_is_told_apart(scored):
    share = scored.share.to_series()
    assert share["nameable"] == 0.5
    assert share["named_nameable"] == 0.0  # gravity was named, but by luck
    assert scored.share_count.to_series()["named_nameable"] == 1
    assert share["recognisable"] == share["unlisted_recognisable"] == 1.0  # joint play


def test_the_page_counts_right_names_by_effect_and_protocol():
    rows = tabulate_cases(NAMES, TRUTHS, ANSWERS, LIMITS)
    hidden = {**rows[0], "visible": False, "protocol": "triangle"}
    table = build_protocols([*rows, hidden])
    cells = {row[0].text: [cell.text for cell in row[1:]] for row in table.rows}
    assert table.columns == ("concealed", "single step", "triangle", "all")
    assert cells == {
        "gravity": ["1 of 1", "(+1)", "1 of 1 (+1)"],
        "inertia": ["0 of 1", "–", "0 of 1"],
    }


def test_a_page_without_a_buried_case_says_so(scored):
    assert "No visible effect whose residual is at the noise" in _render(scored)


def test_real_recordings_are_marked_measured(scored):
    rows = [tabulate_measured("creep-190", "fractional_creep", _answer("adequate"))]
    page = _render(scored, measured=rows)
    assert "Every campaign (measured)" in page
    assert "fractional_creep (known)" in page


def test_a_crash_counts_as_wrong_and_is_counted(scored):
    share = scored.share.to_series()
    assert share["named"] == 0.5
    assert share["crashed"] == 0.25
    assert share["strength_zero_adequate"] == 1.0
    rows = tabulate_cases(NAMES, TRUTHS, ANSWERS, LIMITS)
    assert [row["right"] for row in rows] == [True, True, True, False]
    assert rows[3]["reason"] == "ValueError: <no>"


@pytest.mark.parametrize(
    ("known", "answer", "right"),
    [
        ("inertia + actuator_lag", _answer("named", "actuator_lag", "inertia"), True),
        ("inertia + actuator_lag", _answer("named", "inertia"), False),
        ("ambiguous", _answer("ambiguous", "inertia"), True),
        ("ambiguous", _answer("named", "inertia"), False),
        ("inertia", _answer("unlisted", "inertia"), False),
    ],
)
def test_what_is_known_of_real_recordings_must_be_named_exactly(known, answer, right):
    assert tabulate_measured("x", known, answer)["right"] is right


def test_an_answer_is_told_in_a_line():
    verdict = _answer("ambiguous", "gravity", equivalent=[["gravity", "none"]])["verdict"]
    assert describe_answer(verdict) == "ambiguous: gravity or none"
    named = _answer("named", "gravity")["verdict"]
    assert describe_answer(named) == "named: gravity (joint 2)"


def test_the_page_counts_alarms_by_condition():
    truths = [TRUTHS[1], TRUTHS[1] | {"faults": [{"id": "clock_rate"}]}, TRUTHS[0]]
    answers = [ANSWERS[1], ANSWERS[2], ANSWERS[0]]
    table = build_conditions(tabulate_cases(NAMES[:3], truths, answers, [{}] * 3))
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["clock rate", "1 of 1"],
        ["none", "0 of 1"],
    ]


def test_the_page_tells_what_nuisances_cost_and_how_foreign_laws_fare(scored):
    laws = scored.assign_attrs(laws={"law_named_share_single": 0.42})
    assert "Foreign laws: right name of a single effect: 42 %" in _render(laws)
    assert "Foreign laws" not in _render(scored)
