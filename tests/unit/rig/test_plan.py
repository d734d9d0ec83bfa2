from collections import Counter
from copy import deepcopy

import pytest
from ruamel.yaml import YAML

from softfinger.faults import ListedFault
from softfinger.rig.plan import Plan, build_schedule, read_plan
from softfinger.settings import read_settings


def write(values, path):
    YAML().dump(values, path)
    return path


def test_the_schedule_is_balanced_at_any_length_and_follows_the_seed(plan_values):
    def schedule(**changes):
        plan_values["recording"] |= changes
        return [t.profile.name for t in build_schedule(read_settings(Plan, plan_values, "plan"))]

    drawn = schedule(repeats=4, seed=1)
    for repeat in range(4):
        assert len(Counter(drawn[6 * repeat : 6 * repeat + 6])) == 6
    assert schedule(seed=1) == drawn
    assert schedule(seed=2) != drawn
    listed = schedule(order="as_listed")
    assert listed == [profile["name"] for profile in plan_values["profiles"]] * 4
    assert sorted(drawn) == sorted(listed)


def test_trials_have_names_that_sort(plan):
    names = [planned.name for planned in build_schedule(plan)]
    assert names[0] == "trial_001"
    assert names == sorted(names)
    assert len(set(names)) == 60


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda v: v["safety"].update(tension_limit_n=8.5), "'stairs' pulls with 9 N.*is 8.5 N"),
        (
            lambda v: v["profiles"].append(deepcopy(v["profiles"][0])),
            "two profiles are called 'step_8n'",
        ),
        (lambda v: v["profiles"][0].update(shape="stpes"), "profiles.0"),
        (lambda v: v["campaign"].pop("camera"), "campaign.camera is missing"),
        (lambda v: v["campaign"]["finger"].update(joints=2), "campaign.finger: .*link_length_m"),
        (lambda v: v["recording"].update(picture_px=[40, 39]), "out of the picture of 40 × 39 px"),
        (lambda v: v["safety"].pop("heartbeat_s"), "safety.heartbeat_s: field required"),
    ],
)
def test_a_plan_that_no_rig_can_do_is_refused(plan_values, change, said, tmp_path):
    change(plan_values)
    with pytest.raises(ListedFault, match=said):
        read_plan(write(plan_values, tmp_path / "plan.yaml"))


ABSENT = r"absent.yaml cannot be used.*\n.*the file does not exist"


@pytest.mark.parametrize(("text", "said"), [("a: [", "not YAML"), ("7", "keys and values")])
def test_a_plan_that_is_no_yaml_is_refused(text, said, tmp_path):
    (tmp_path / "plan.yaml").write_text(text)
    with pytest.raises(ListedFault, match=said):
        read_plan(tmp_path / "plan.yaml")
    with pytest.raises(
        ListedFault, match=r"absent.yaml cannot be used.*\n.*the file does not exist"
    ):
        read_plan(tmp_path / "absent.yaml")


def test_the_source_is_the_rigs_word_and_not_the_plans(plan_values):
    plan_values["campaign"]["source"] = "measured"
    plan = read_settings(Plan, plan_values, "plan")
    assert plan.describe_campaign("synthetic")["source"] == "synthetic"
