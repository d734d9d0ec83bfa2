"""A computed load becomes a plan that the recorder takes."""

import pytest

from softfinger.faults import Fault
from softfinger.rig.plan import Plan, build_schedule
from softfinger.rig.planned import build_plan, list_paths, list_repeats


def test_one_history_is_repeated_and_several_take_turns():
    one = [{"time_s": [0.0, 2.00004], "load": [4.00049, 4.0]}]
    alone = list_paths(one, 7)
    assert (len(alone), list_repeats(alone, 7)) == (1, 7)
    assert alone[0].time_s == [0.0, 2.0]
    assert alone[0].tension_n == [4.0, 4.0]  # never more than was allowed
    three = list_paths(one * 3, 7)
    assert (len(three), list_repeats(three, 7)) == (7, 1)


def test_a_load_below_what_a_controller_sets_is_refused():
    with pytest.raises(Fault, match="--max-load"):
        list_paths([{"time_s": [0.0, 2.0], "load": [0.0004, 0.0]}], 3)


def test_a_campaigns_description_becomes_a_plan_of_so_many_trials(plan):
    campaign = plan.campaign
    paths = list_paths([{"time_s": [0.0, 2.0], "load": [4.0, 3.0]}], 5)
    content = Plan.model_validate(build_plan(campaign, paths, 5, 30.0, 4.0))
    assert len(build_schedule(content)) == 5
    assert content.safety.tension_limit_n == pytest.approx(4.8)


@pytest.mark.parametrize(
    "change", [{"time_s": [0.0]}, {"time_s": [1.0, 2.0]}, {"time_s": [0.0, -1.0]}]
)
def test_a_path_starts_at_0_and_goes_forward(change):
    from pydantic import ValidationError

    from softfinger.rig.profiles import LoadPath

    right = {"name": "a", "shape": "path", "time_s": [0.0, 2.0], "tension_n": [1.0, 0.0]}
    LoadPath.model_validate(right)
    with pytest.raises(ValidationError):
        LoadPath.model_validate(right | change)
