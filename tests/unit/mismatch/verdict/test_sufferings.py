"""What recordings suffer from, in words."""

import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.words import WORDS
from softfinger.mismatch.verdict.sufferings import describe_measurement, doubt_declared


def build_measurement(found):
    names = list(found)
    return xr.Dataset(
        {
            "component_size": ("component", [found[name][0] for name in names]),
            "component_evidence": ("component", [found[name][1] for name in names]),
            "trial_factor": (("trial", "joint"), [[1.0, 1.1], [4.0, 4.2], [0.9, 1.0]]),
            "outlier_distance": (("trial", "frame"), [[0.0, 0.0], [0.0, 0.0], [0.0, 40.0]]),
            "repeated": (("trial", "frame"), [[False, True], [False, False], [False, False]]),
            "saturated": (("trial", "frame"), [[False, False], [False, True], [False, False]]),
            "noise_sd": ("joint", [0.003, 0.003]),
            "hum_frequency": ("hum", [7.1, 14.2]),
        },
        {"component": names, "trial": ["a", "b", "c"]},
    )


def test_every_component_has_a_sentence_and_the_strongest_comes_first():
    found = {name: (0.005, 10.0 + k) for k, name in enumerate(WORDS)}
    told = describe_measurement(build_measurement(found))
    faults = {name: words for name, words in WORDS.items() if words.fault}
    assert len(told) == len(faults) == len(WORDS) - 2
    assert [one.evidence for one in told] == sorted((one.evidence for one in told), reverse=True)
    assert all(one.statement.endswith(".") for one in told)
    assert {one.id for one in told} == {words.id or name for name, words in faults.items()}


def test_what_only_keeps_an_effect_from_being_claimed_is_not_claimed_itself():
    assert describe_measurement(build_measurement({"drift": (1.0, 4.0)})) == []


@pytest.mark.parametrize("name", ["lasting_noise", "flicker_noise"])
def test_how_long_the_noise_lasts_is_no_fault(name):
    assert describe_measurement(build_measurement({name: (1.0, 90.0)})) == []


def test_a_hum_is_told_with_its_frequencies_as_a_drift():
    told = describe_measurement(build_measurement({"hum": (0.0008, 20.0)}))
    assert [one.id for one in told] == ["drift"]
    assert told[0].size == {"amplitude_rad": 0.0008}
    expected = "The angles hum at 7.1 and 14.2 Hz with 0.8 mrad, whatever the load does."
    assert told[0].statement == expected


def test_noise_of_a_specimen_is_told_in_its_units():
    names = {"hum": (0.0008, 20.0), "rate_noise": (2.0, 20.0)}
    units = {"motion_unit": "mm", "motion_per_rad": 20.0, "load_unit": "N"}
    told = describe_measurement(build_measurement(names).assign_attrs(units))
    assert {one.statement for one in told} == {
        "The motion hums at 7.1 and 14.2 Hz with 0.016 mm, whatever the load does.",
        "The noise grows with the speed: from 0.06 mm at rest to 0.13 mm at 20 mm/s.",
    }


def test_a_link_whose_markers_drift_names_the_joints_beside_it():
    told = describe_measurement(build_measurement({"link_turn_1": (1.5, 20.0)}))
    assert [(one.id, one.joints) for one in told] == [("drift", [1, 2])]
    assert told[0].statement.startswith("Link 1 seems to turn within a trial by 1.5 times")


def test_the_trials_that_suffer_are_named():
    told = describe_measurement(
        build_measurement(
            {
                "uneven_noise": (0.6, 30.0),
                "outliers": (0.01, 20.0),
                "repeated_frames": (0.1, 9.0),
                "saturated_sensor": (0.02, 8.0),
            }
        )
    )
    assert [one.trials for one in told] == [["b"], ["c"], ["a"], ["b"]]
    assert "that of b is 4.1 times" in told[0].statement


def test_a_log_that_scatters_is_told_in_newton():
    told = describe_measurement(build_measurement({"noisy_load": (0.005, 30.0)}))
    assert told[0].size == {"relative_sd": 0.005}
    assert told[0].statement == "The load log scatters by 0.5 %: 0.05 N at 10 N."
    assert np.isclose(told[0].evidence, 30.0)


def test_a_declared_sd_that_the_recordings_contradict_is_doubted():
    found = build_measurement({})
    shown = found["noise_sd"] * np.array([2.5, 2.2])
    told = doubt_declared(found.assign(recorded_noise_sd=shown))
    assert [one.id for one in told] == ["declared_noise"]
    assert "recordings show 2.3 times that" in told[0].statement
    assert doubt_declared(found.assign(recorded_noise_sd=1.5 * found["noise_sd"])) == []
