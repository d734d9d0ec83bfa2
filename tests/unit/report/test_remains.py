import pytest
from example_artifacts import gather, make_angles

from softfinger.report.sections.remains import build_remains, describe_unlisted, state_location
from softfinger.summary.diagnosis import summarise_location

LOCATION = {
    "level": "within_trial",
    "joints": {"1": 0.001, "2": 0.02, "3": 0.7},
    "times_s": (0.1, 3.0),
    "trials": None,
    "covariate": None,
}


def say(location):
    found = summarise_location(make_angles(), {"location": location}, None)
    return state_location(location, found)


@pytest.fixture
def unlisted(diagnosed):
    shape = {"argument": "rate_rad_per_s", "joints": [2], "artifact": "free_form.nc"}
    said = {"decision": "unlisted", "location": LOCATION, "free_form": shape}
    verdict = diagnosed["verdict"] | said
    return gather({**diagnosed, "verdict": verdict, "location": mark_line(diagnosed, 0.5)})


def mark_line(diagnosed, p_value):
    line = {"line_frequency": 3.4, "line_joint": 2, "line_p_value": p_value}
    return diagnosed["location"].assign({name: ((), value) for name, value in line.items()})


def test_what_is_unlisted_is_located_and_its_shape_is_drawn(unlisted):
    where, shape, picture = describe_unlisted(unlisted)
    assert where.text == (
        "It shows within trials in joints 1 and 2, 0.1 s to 3 s after the load changed."
    )
    assert "depends on the rate at which the joint moves" in shape.text
    assert "a free-form curve of that in joint 2 gains 119 nats" in shape.text
    assert "with it minus without: 101 ± 12 nats" in shape.text
    assert "by 1 % with it and by 40 % without" in shape.text
    assert picture.name == "free_form"
    assert "free_form" in [getattr(b, "name", "") for b in build_remains(unlisted).blocks]


def test_a_spectral_line_is_told(unlisted, diagnosed):
    artifacts = {**unlisted.artifacts, "location": mark_line(diagnosed, 1e-6)}
    words = [getattr(block, "text", "") for block in describe_unlisted(gather(artifacts))]
    assert "A spectral line at 3.4 Hz is far above the rest of what is left, in joint 2." in words


def test_what_is_listed_needs_no_shape(diagnosed):
    assert describe_unlisted(gather(diagnosed)) == []


def test_a_misfit_between_trials_or_of_jumps_is_located_as_such():
    between = {**LOCATION, "level": "between_trials", "covariate": "largest_load"}
    assert say(between) == (
        "It shows between trials in joints 1 and 2, with the trial's largest load."
    )
    slipped = {**LOCATION, "level": "measurement", "trials": ["t3", "t5"], "joints": {"2": 0.001}}
    assert say(slipped) == (
        "It shows as jumps of the recording in joint 2, in 2 trials: t3 and t5."
    )
