import pytest

from softfinger.faults import ListedFault
from softfinger.virtual_rig.config import read_config


def test_counts_the_frames_of_a_trial(config):
    assert read_config(config).n_frames == 7
    assert read_config(config | {"duration_s": 30.0, "fps": 30.0}).n_frames == 900


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"fsp": 30.0}, "fsp: extra inputs are not permitted, got 30.0"),
        ({"fps": -1.0}, "fps: input should be greater than 0, got -1.0"),
        ({"blur_px": 0.0}, "blur_px: input should be greater than or equal to 0.3, got 0.0"),
        ({"load_time_s": [0.0]}, "load_time_s has 1 values but load_tension_n 4"),
        ({"load_time_s": [0.0, 0.3, 0.2, 0.7]}, "load_time_s runs backwards"),
        ({"link_length_m": [0.025]}, "link_length_m: list should have at least 3 items"),
    ],
)
def test_names_the_key_and_the_value(config, change, sentence):
    with pytest.raises(ListedFault) as caught:
        read_config(config | change)
    assert sentence in str(caught.value)


def test_lists_every_fault(config):
    del config["fps"]
    with pytest.raises(ListedFault) as caught:
        read_config(config | {"n_trials": 0})
    assert len(caught.value.faults) == 2
