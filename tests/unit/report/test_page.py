import base64
import hashlib
import re
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr
from example_artifacts import CONFIG, gather, make_angles, make_artifacts, sum_up

from softfinger.report import write_report
from softfinger.report.page import REPORT, render_report
from softfinger.report.pictures.mismatch import picture_location
from softfinger.report.pictures.repair import picture_repair
from softfinger.report.pictures.spread import picture_densities
from softfinger.report.sections.mismatch import build_mismatch, judge_mismatch
from softfinger.report.verdict import state_verdict

VOID = {"meta", "img", "link", "br", "input", "hr"}
FIRST = ["verdict", "motion", "spread", "causes", "measurement", "next"]
FOLDED = [
    "data",
    "measured",
    "model",
    "computation",
    "calibration",
    "predictive",
    "parameters",
    "sensitivity",
    "mismatch",
    "remains",
    "explained",
    "catalogue",
    "outlook",
    "origin",
]


class Page(HTMLParser):
    """Elements, words and tables of a page; a tag that is closed wrongly fails."""

    def __init__(self, source):
        super().__init__()
        self.open, self.elements, self.words, self.tables = [], [], [], {}
        self.feed(source)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.rows = self.tables[dict(attrs)["data-name"]] = []
        if tag == "tr":
            self.rows.append([])
        if tag in {"td", "th"}:
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in {"script", "style"}:
            self.words.append(data)
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data.strip("\n")

    def find(self, tag, **wanted):
        return [a for t, a in self.elements if t == tag and wanted.items() <= a.items()]

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def parsed(page):
    return Page(page)


def render(artifacts):
    return render_report(gather(artifacts))


def build_tables(artifacts):
    """The page's tables before they are rendered, which spares drawing the figures."""
    material = gather(artifacts)
    builds = (*REPORT.first, *REPORT.referee)
    blocks = [block for build in builds for block in build(material).blocks]
    tables = {block.name: block for block in blocks if block.kind == "table"}
    rows = {n: [t.columns, *([c.text for c in r] for r in t.rows)] for n, t in tables.items()}
    words = [getattr(block, "text", "") for block in blocks]
    words += [item for block in blocks if block.kind == "listing" for item in block.items]
    words += [block.caption for block in blocks if block.kind in {"table", "picture"}]
    return rows, " ".join(words)


def test_sections_come_in_the_order_of_the_house(parsed):
    assert [section["id"] for section in parsed.find("section")] == FIRST
    assert [part["id"] for part in parsed.find("details", **{"class": "part"})] == FOLDED
    links = [a["href"][1:] for a in parsed.find("a") if a["href"].startswith("#")]
    contents = [link for link in links if link in {*FIRST, *FOLDED}]
    places = [contents.index(anchor) for anchor in FIRST]
    assert contents[places[0] : places[-1] + 1] == FIRST
    assert contents[places[-1] + 1 :][: len(FOLDED)] == FOLDED


def test_every_link_within_the_page_leads_somewhere(parsed):
    ids = [attrs["id"] for _, attrs in parsed.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for a in parsed.find("a")} <= set(ids)
    for _, attrs in parsed.elements:
        assert attrs.get("aria-labelledby", ids[0]) in ids


def test_the_page_needs_no_other_file_and_no_network(page, parsed):
    for tag, attrs in parsed.elements:
        address = attrs.get("src", "data:")
        assert address.startswith("data:"), tag
    assert not parsed.find("link")
    assert not re.search(r"(?:src|href|url)\s*[=(]\s*[\"']?https?:", page)


def test_every_figure_is_an_svg_with_words_for_those_who_do_not_see_it(parsed):
    images = parsed.find("img")
    assert len(images) == 16
    for image in images:
        head, code = image["src"].split(",")
        assert head == "data:image/svg+xml;base64"
        assert b"<svg" in base64.b64decode(code)[:1000]
        assert len(image["alt"]) > 30


def test_only_the_pages_own_script_may_run(page):
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', page)[1]
    script = re.search(r"<script>(.*)</script>", page, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy.replace("&#39;", "'")
    assert "default-src 'none'" in policy.replace("&#39;", "'")


def test_same_artifacts_same_bytes(artifacts, tmp_path):
    few = sum_up({name: artifacts[name] for name in ("angles", "sobol")})
    for name in ("one.html", "two.html"):
        write_report(few, CONFIG, tmp_path / name, commit="0123abc")
    one, two = ((tmp_path / name).read_text() for name in ("one.html", "two.html"))
    assert one == two
    assert "Commit of the code: 0123abc" in one


def test_the_page_stays_small_enough_to_send(page):
    assert len(page) < 4e6


def test_folders_of_this_machine_stay_out(page):
    assert CONFIG["campaign"] not in page


def test_source_and_every_trial_set_aside_are_told(parsed):
    assert "synthetic data" in parsed.text
    assert parsed.tables["set_aside"][1:] == [
        ["trial_x", "video/trial_x.avi: no frame can be read"]
    ]


def test_a_failed_check_turns_red_and_the_report_is_whole(parsed):
    tiles = [a["class"] for a in parsed.find("li") if a.get("class", "").startswith("tile")]
    assert tiles == ["tile bad", "tile open", "tile open", "tile open"]
    assert "Failed: largest R-hat" in parsed.text
    assert len(parsed.tables["centres"]) == 1 + 4 * 3


def test_numbers_are_the_artifacts_own(artifacts, parsed):
    draws = np.exp(artifacts["posterior"]["posterior"].dataset["mu_log_k_v"].sel(joint=1))
    row = parsed.tables["centres"][1]
    assert row[:3] == ["kv", "1", "N m/rad"]
    assert float(row[3].split(" ± ")[0]) == pytest.approx(float(draws.median()), rel=0.01)
    low, high = np.quantile(draws, [0.05, 0.95])
    assert [float(end) for end in row[4].split(" to ")] == pytest.approx([low, high], rel=0.01)
    two_stage = np.exp(artifacts["least_squares"]["population_mean"].values[0, 0])
    assert float(row[5]) == pytest.approx(two_stage, rel=0.01)
    assert float(row[6]) == pytest.approx(np.exp(-2.4441), rel=0.01)


def list_parts(artifacts):
    """Anchors of the sections, names of their blocks and of the checks."""
    sections = [build(gather(artifacts)) for build in (*REPORT.first, *REPORT.referee)]
    blocks = [block for section in sections for block in section.blocks]
    checks = [check.name for block in blocks if block.kind == "checks" for check in block.checks]
    names = {block.name for block in blocks if hasattr(block, "name")}
    return [section.anchor for section in sections], names, checks


def test_a_model_with_effects_has_every_part_of_the_base(artifacts):
    few = {name: artifacts[name] for name in ("angles", "posterior", "sampling", "bands")}
    tree = few["posterior"].copy()
    effect = (("chain", "draw", "effect_parameter"), np.full((4, 60, 1), 1.2))
    tree["posterior"] = (
        tree["posterior"]
        .to_dataset()
        .assign(effect=effect)
        .assign_coords(effect_parameter=["moment_arm.arm_scale"])
    )
    base, effects = list_parts(few), list_parts({**few, "posterior": tree})
    assert effects[0] == base[0]
    assert effects[1] == base[1] | {"fitted_effects"}
    assert effects[2] == base[2]
    tables, words = build_tables({**few, "posterior": tree})
    assert tables["fitted_effects"][1][:3] == ["moment arm", "arm_scale", "1.2"]
    assert "the fitted model adds moment arm" in words
    assert "The fit was not run" not in words


def test_other_artifacts_give_other_numbers(artifacts):
    moved = {**artifacts, "posterior": artifacts["posterior"].copy(deep=True)}
    draws = moved["posterior"]["posterior"].dataset
    moved["posterior"]["posterior"].dataset = draws.assign(mu_log_k_v=draws["mu_log_k_v"] + 1)
    other, before = (
        build_tables({name: source[name] for name in ("angles", "posterior")})[0]["centres"][1][3]
        for source in (moved, artifacts)
    )
    ratio = float(other.split(" ± ")[0]) / float(before.split(" ± ")[0])
    assert ratio == pytest.approx(np.e, rel=0.02)


def test_names_from_outside_stay_text(artifacts):
    hostile = '<script>alert(1)</script> & "k_v" $x$'
    angles = artifacts["angles"].assign_attrs(campaign=hostile)
    angles["set_aside_reason"] = ("set_aside_trial", ["</td><img src=x onerror=alert(2)>"])
    page = render({"angles": angles})
    assert page.count("<script>") == 1
    assert "<img src=x" not in page
    assert hostile in Page(page).text


def test_a_command_gets_units_per_command_and_no_paper():
    tables, words = build_tables(make_artifacts(n_joint=3, load_kind="command", load_scale=2500.0))
    assert tables["centres"][1][2] == "command/rad"
    assert "the paper" not in tables["centres"][0]
    assert "cannot be compared" in words
    assert "n = 10 trials in 2 protocols" in words
    assert tables["coverage"][1][0] == "load 100 command"


def test_an_assumed_load_is_said_to_be_assumed():
    _, words = build_tables({"angles": make_angles(n_joint=1, load_kind="assumed")})
    assert "a unit command from the first frame was assumed" in words


@pytest.mark.parametrize(("n_joint", "n_trial"), [(1, 1), (5, 4)])
def test_any_number_of_joints_and_trials_has_its_report(n_joint, n_trial):
    tables, words = build_tables(make_artifacts(n_joint=n_joint, n_trial=n_trial))
    assert len(tables["centres"]) == 1 + 4 * n_joint
    assert len(tables["trials"]) == 1 + n_trial
    assert "nan" not in words
    alone = n_trial == 1
    assert ("coverage" not in tables) == alone
    assert ("all shares of the spread that follow are those of the prior" in words) == alone


def test_the_main_cause_is_told_where_the_spread_is_widest(artifacts):
    sobol = artifacts["sobol"].copy(deep=True)
    early = np.where(sobol["time"] == 1.0, 9.0, 0.1)
    sobol["angle_sd"] = sobol["angle_sd"] * 0 + xr.DataArray(early, dims="time")
    shares = sobol["first_order"].sel(estimate="posterior", joint=2, time=1.0)
    name = str(shares["parameter"].values[int(shares.argmax("parameter"))])
    _, words = build_tables({"angles": artifacts["angles"], "sobol": sobol})
    assert f"{name} at joint 2 ({100 * float(shares.max()):.0f} % after 1 s)" in words


def test_pairs_whose_interval_leaves_zero_out_are_named(artifacts):
    few = {name: artifacts[name] for name in ("angles", "sobol", "shapley")}
    page = Page(render(few))
    n = artifacts["angles"]["joint"].size
    assert f"{2 * n} of {6 * n} pairs, where chance alone would give about" in page.text


def test_a_frame_of_the_film_keeps_its_colours_in_the_dark(artifacts):
    picture = xr.Dataset(
        {"picture": (("row", "column", "channel"), np.full((30, 40, 3), 128, np.uint8))},
        coords={"trial": "trial_002", "frame": 7},
    )
    few = {name: artifacts[name] for name in ("angles", "markers")}
    page = Page(render({**few, "picture": picture}))
    photographs = [image["data-title"] for image in page.find("img", **{"class": "true-colours"})]
    assert photographs == ["What the tracking saw"]
    assert "Frame 7 of trial trial_002, on the picture itself" in page.text


def test_protocols_stand_in_the_order_of_their_loads():
    made = make_artifacts(load_kind="command", load_scale=2500.0)
    angles = made["angles"].copy(deep=True)
    angles["load_torque"] = 300 - angles["load_torque"]
    assert gather({**made, "angles": angles}).bands["protocol"].values.tolist() == [
        "load 100 command",
        "load 200 command",
    ]
    assert gather({**made, "angles": angles}).bands["coverage"].sizes["protocol"] == 2


def test_missing_artifacts_are_said_to_be_missing(artifacts):
    page = Page(render({"angles": artifacts["angles"]}))
    assert [section["id"] for section in page.find("section")] == FIRST
    for sentence in (
        "The fit was not run",
        "The sensitivity was not computed",
        "The mismatch diagnosis was not run",
        "the bands were not computed",
    ):
        assert sentence in page.text


def test_the_verdict_is_told_in_words(artifacts):
    verdict = {
        "decision": "ambiguous",
        "effects": [
            {
                "id": "second_retardation",
                "joints": [2],
                "probability": 0.6,
                "parameters": {
                    "retardation_time_s": {"mean": 5.9, "sd": 0.4, "q05": 5.2, "q95": 6.6}
                },
                "statement": "Joint 2 keeps relaxing.",
            }
        ],
        "equivalent": [["second_retardation", "fractional_creep"]],
        "elpd": {"baseline": 0.0, "final": 30.0, "difference": 30.0, "se": 4.0},
        "residual_rms_rad": {"baseline": 0.0065, "final": 0.0031, "noise": 0.003},
        "not_testable": ["yield_threshold"],
        "next_experiment": None,
    }
    tables, words = build_tables({"angles": artifacts["angles"], "verdict": verdict})
    assert "Joint 2 keeps relaxing." in words
    assert "second retardation and fractional creep" in words
    assert "Physics is missing, but these recordings cannot tell" in words
    assert tables["effects"][1][4] == "5.9 ± 0.4"
    assert tables["before_after"][1] == ["base model", "6.50"]


def test_every_effect_is_told_whether_it_was_tried_or_not(diagnosed):
    few = {name: diagnosed[name] for name in ("angles", "ranking", "verdict")}
    rows = build_tables(few)[0]["catalogue"][1:]
    gains = diagnosed["ranking"]["best_gain"].sel(effect="wire_friction")
    assert rows[1][0] == "wire friction"
    assert float(rows[1][2].replace("−", "-")) == pytest.approx(float(gains), rel=0.01)
    assert rows[-1][0] == "temperature"
    assert rows[-1][2:] == ["–", "–", "not tried: temperature was not logged"]


def test_what_is_named_beside_something_unlisted_is_no_whole_answer(diagnosed):
    verdict = {**diagnosed["verdict"], "decision": "unlisted"}
    few = {"angles": diagnosed["angles"], "verdict": verdict}
    tile = judge_mismatch(gather(few))
    assert tile.detail.endswith("(probability 98 %) and more that no listed effect explains")
    assert state_verdict(gather(few)) == (
        "Something is missing, of which second retardation is only a part; with it, what "
        "remains is 1.02 times what the measurement allows."
    )
    nothing = {**few, "verdict": {**verdict, "effects": []}}
    assert "and no listed effect explains it" in state_verdict(gather(nothing))


def test_nothing_is_claimed_beyond_the_recordings(artifacts):
    material = gather(artifacts)
    last = artifacts["angles"]["time"].max() + artifacts["angles"]["time"].diff("frame").median()
    assert float(material.recordings["duration"]) == pytest.approx(float(last))
    longer = artifacts["sobol"].assign_coords(running_time=[1.0, 1e3])
    rows = build_tables({"angles": artifacts["angles"], "sobol": longer})[0]["design"][1:]
    assert {row[0] for row in rows} == {"1"}
    later = artifacts["densities"].copy()
    later["time"] = [*later["time"].values[:-1], 1e3]
    axes = picture_densities(gather({**artifacts, "densities": later})).figure.axes
    assert "1000 s" not in [label.get_text() for label in axes[0].get_yticklabels()]


def test_a_model_that_needed_no_repair_is_shown_once(diagnosed):
    verdict = {**diagnosed["verdict"], "decision": "adequate", "effects": []}
    material = gather({**diagnosed, "verdict": verdict})
    tables = {b.name: b for b in build_mismatch(material).blocks if b.kind == "table"}
    assert [row[0].text for row in tables["before_after"].rows] == [
        "base model",
        "noise, measured without a model",
    ]
    assert "the base model" in picture_repair(material).alt
    labels = picture_repair(material).figure.axes[0].get_legend_handles_labels()[1]
    assert labels == ["recordings", "base model"]
    titles = [ax.get_title() for ax in picture_location(material).figure.axes]
    assert not [title for title in titles if "repaired" in title]
