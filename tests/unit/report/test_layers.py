"""The report's two layers: what the head of a lab reads, and what a paper can cite."""

import re
from functools import cache

import pytest
import xarray as xr
from example_artifacts import gather, sum_up
from test_page import Page

from softfinger.provenance import PROJECT
from softfinger.report.blocks import Tile
from softfinger.report.overview.following import build_next
from softfinger.report.overview.measurement import MOST_FINDINGS, build_measurement
from softfinger.report.overview.verdict import build_verdict
from softfinger.report.page import DIAGNOSIS, REPORT, choose_plan, render_report
from softfinger.report.sections.tiles import judge_tiles, reconcile
from softfinger.report.verdict import state_explained
from softfinger.stages.opening import DIAGNOSED

MOST_WORDS, MOST_FIGURES = 900, 5
LOCATION = {
    "level": "within_trial",
    "joints": {"1": 0.001, "2": 0.02, "3": 0.7},
    "times_s": (0.1, 3.0),
    "trials": None,
    "covariate": None,
}
MANY = "A finding of the measurement, which takes about as many words as such a sentence has."


def change(diagnosed, **said):
    return {**diagnosed, "verdict": diagnosed["verdict"] | said}


def make_unlisted(diagnosed):
    """Nothing fits, and everything that can be said is said."""
    verdict = diagnosed["verdict"]
    part = {"trials": [], "joints": [], "size": {"share": 0.1}, "evidence": 9.0, "statement": MANY}
    return sum_up(
        change(
            diagnosed,
            decision="unlisted",
            effects=[{**verdict["effects"][0], "statement": MANY} for _ in range(5)],
            location=LOCATION,
            remaining={"rms_over_noise": 5.3, "p_value": 1e-9, "where": "joint 2, holding"},
            free_form={"argument": "rate_rad_per_s", "joints": [2], "artifact": "free_form.nc"},
            measurement=[{"id": f"finding_{k}", **part} for k in range(12)],
            warnings=[{"id": "x", "trials": [], "statement": f"{MANY} {k}"} for k in range(12)],
            next_experiment={"statement": MANY, "expected_gain_nats": {}, "loads": []},
        )
    )


def make_diagnosis_only(diagnosed):
    kept = {"angles", "verdict", *DIAGNOSED}
    return sum_up({name: diagnosed[name] for name in diagnosed if name in kept})


KINDS = {
    "effect": lambda diagnosed: diagnosed,
    "adequate": lambda diagnosed: sum_up(change(diagnosed, decision="adequate", effects=[])),
    "unlisted": make_unlisted,
    "diagnosis": make_diagnosis_only,
    "fit": lambda diagnosed: sum_up({k: v for k, v in diagnosed.items() if k in FITTED}),
}
FITTED = {"angles", "posterior", "least_squares", "sampling", "bands", "sobol"}


@pytest.fixture(scope="module")
def render(diagnosed):
    """The material and the page of a kind; figures are drawn, but not rendered to save time."""

    @cache
    def make(kind):
        material = gather(KINDS[kind](diagnosed))
        return material, render_report(material)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("softfinger.report.blocks.render_figure", lambda *_: b"<svg/>")
        yield make


@pytest.fixture(params=list(KINDS))
def source(request, render):
    return render(request.param)[1]


def read_first(source):
    """The page's head and first layer, without the contents."""
    first = source[source.index("<body>") : source.index('<div class="referee">')]
    return re.sub("<nav.*?</nav>", "", first, flags=re.DOTALL)


def count_words(source):
    return len(re.sub("<[^>]+>", " ", read_first(source)).split())


def list_titles(source):
    return re.findall('data-title="([^"]+)"', read_first(source))


def test_the_first_layer_takes_two_minutes(source):
    assert 150 < count_words(source) <= MOST_WORDS
    assert 1 <= len(list_titles(source)) <= MOST_FIGURES


def test_every_link_leads_somewhere_and_every_figure_has_words(source):
    page = Page(source)
    ids = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for a in page.find("a")} <= set(ids)
    assert all(len(image["alt"]) > 30 for image in page.find("img"))


def test_each_part_links_to_what_it_relies_on(source):
    sections = re.findall(r"<section id.*?</section>", source, re.DOTALL)
    referee = source[source.index('<div class="referee">') :]
    for section in sections:
        more = re.findall(r'href="#([\w-]+)"', section.partition('<p class="more">')[2])
        assert more or 'class="note"' in section or "figure" in section
        assert all(f'id="{anchor}"' in source for anchor in more)
    assert referee.count("Permanent link to this part") == referee.count('<details class="part"')


def test_evidence_bands_and_causes_are_shown(render):
    assert list_titles(render("effect")[1]) == [
        "The evidence",
        "Recordings with both models",
        "Which parameter causes the spread",
        "What the recordings suffer from",
    ]


def test_a_diagnosis_alone_has_its_own_page(render):
    material, page = render("diagnosis")
    assert choose_plan(material) is DIAGNOSIS
    assert choose_plan(render("effect")[0]) is REPORT
    assert [s["id"] for s in Page(page).find("section")] == [
        "verdict", "motion", "remains", "measurement", "explained", "next",
    ]  # fmt: skip
    assert "was not run" not in page
    assert [tile.answer for tile in judge_tiles(material)] == ["found", "noise", "1 finding"]


def test_what_is_unlisted_tells_all_that_is_known(render):
    page = Page(render("unlisted")[1]).text
    for words in (
        "explains 90 % of the missing evidence",
        "what remains is 5.30 times what the measurement allows",
        "chance alone leaves as much in less than 0.1 % of campaigns",
        "Where it shows most: joint 2, holding",
        "It shows within trials in joints 1 and 2",
        "depends on the rate at which the joint moves",
        "Not tried: temperature; temperature was not logged",
    ):
        assert words in page


def test_an_effect_that_turned_back_is_said_to_be_none(diagnosed):
    verdict = change(diagnosed, decision="unlisted", effects=[])["verdict"]
    assert len(state_explained(verdict)) == 1
    best = verdict["explained"][0] | {"turned_back": ["softening_within_trial"]}
    said = state_explained(verdict | {"explained": [best]})
    assert "softening within trial falls and rises again" in said[1]


def test_warnings_come_before_the_verdict_and_a_next_experiment_last(diagnosed):
    proposal = {
        "statement": "6 trials would show wire_friction.",
        "expected_gain_nats": {"wire_friction": 20.0},
        "loads": [{"time_s": [0.0], "load": [1.0]}],
    }
    doubts = xr.Dataset({"statement": ("doubt", ["trial_002 is unlike the others"])})
    material = gather({**change(diagnosed, next_experiment=proposal), "doubts": doubts})
    assert build_verdict(material).blocks[0].text == "Warning: trial_002 is unlike the others."
    assert build_measurement(material).blocks[0].items[:2] == (
        "trial_002 is unlike the others.",
        "1 % of the frames are gross errors, and are left out.",
    )
    said = build_next(material).blocks[0].items[0]
    assert said.startswith("6 trials would show wire friction. Its load logs lie")
    unseen = gather(change(diagnosed, next_experiment={**proposal, "loads": []}))
    assert build_next(unseen).blocks[0].items[0] == "6 trials would show wire friction."


def test_long_lists_point_to_where_the_rest_is(render):
    material = render("unlisted")[0]
    items = build_measurement(material).blocks[0].items
    assert items[MOST_FINDINGS] == f"{24 - MOST_FINDINGS} more: see the numbers."
    assert (
        build_verdict(material)
        .blocks[0]
        .text.endswith("11 more: see what the recordings suffer from.")
    )


def tile(answer, passed):
    return Tile("question", answer, passed, "detail", "anchor")


def test_no_tile_contradicts_another():
    sound, bad = tile("sound", True), tile("not sound", False)
    good, none, found = tile("as claimed", True), tile("none is left", True), tile("found", False)
    clean, left = tile("none seen", True), tile("some is left", False)
    assert [t.passed for t in reconcile(sound, good, none, clean)] == [True] * 4
    assert [t.passed for t in reconcile(sound, good, none, found)] == [True, True, None, False]
    assert [t.passed for t in reconcile(sound, good, left, clean)] == [True, True, False, None]
    assert [t.passed for t in reconcile(bad, good, none, clean)] == [False, None, None, True]
    assert "within trials" in reconcile(sound, good, none, found)[2].detail


def test_every_tile_states_its_power(render):
    details = [tile.detail for tile in judge_tiles(render("effect")[0])]
    assert "would fail" in details[1]
    assert "on it would be seen" in details[2]
    assert "of 4 effects could have been seen" in details[3]


PARTS = (
    "verdict motion spread causes measurement next referee data measured model computation "
    "calibration predictive parameters sensitivity mismatch remains explained catalogue outlook "
    "origin"
)
FIGURES = (
    "evidence repair sobol measurement recordings tracking finger joint_model prior_predictive "
    "sampling bands bands_early residuals hyperparameters histograms initial_angles shapley "
    "densities laws location ranking masking assumptions"
)
TABLES = (
    "in_short set_aside trials findings noise computation_checks calibration_checks coverage "
    "fit_checks residual_size centres spreads sobol design correlations effects before_after "
    "parameter_bias left_out_trials left_out_levels explained_sets catalogue artifacts "
    "configuration"
)


def test_anchors_that_papers_cite_stay(render):
    page = Page(render("effect")[1])
    ids = {attrs["id"] for _, attrs in page.elements if "id" in attrs}
    promised = {*PARTS.split(), *(f"figure-{name}" for name in FIGURES.split())}
    promised |= {f"table-{name}" for name in TABLES.split()}
    assert promised - ids == set()
    cited = {one for one in ids if not one.startswith(("title-", "caption-"))} - {"main"}
    assert cited == promised


def test_the_documentation_names_anchors_that_there_are():
    page = (PROJECT / "docs/report.md").read_text(encoding="utf-8")
    table = page[page.index("| first layer") : page.index("## Figures for")]
    named = re.findall(r"`([\w-]+)`", table)
    promised = {*PARTS.split(), *(f"figure-{name}" for name in FIGURES.split())}
    promised |= {f"table-{name}" for name in TABLES.split()}
    assert {one for one in named if not one.endswith("-")} <= promised
    assert {*PARTS.split()} - {"referee"} <= set(named)
