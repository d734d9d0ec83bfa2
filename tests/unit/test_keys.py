"""Which keys of the configuration each stage is given; `test_architecture` compares with code."""

import pytest

from softfinger.config import read_config
from softfinger.mismatch.config import MismatchSettings
from softfinger.propagation.config import PropagateConfig, ShapleyConfig, SobolConfig
from softfinger.stages.keys import KEYS, choose_settings
from softfinger.summary.config import ReportConfig
from softfinger.tracking.config import TrackingConfig
from softfinger.virtual_rig.config import FilmConfig, RigConfig

PARTS = {
    "film": FilmConfig,
    "virtual_rig": RigConfig,
    "angles": TrackingConfig,
    "propagate": PropagateConfig,
    "sobol": SobolConfig,
    "shapley": ShapleyConfig,
    "diagnose": MismatchSettings,
    "summarise": ReportConfig,
}


@pytest.mark.parametrize(("stage", "part"), PARTS.items())
def test_what_a_stage_is_given_is_what_its_package_declares(stage, part):
    assert set(KEYS[stage][1]) == set(part.model_fields)


@pytest.mark.parametrize(
    ("key", "value", "stages"),
    [
        ("cores", 7, set()),
        ("outlier_cutoff", 2.5, {"least_squares"}),
        ("r_hat_max", 1.02, {"sampling"}),
        ("target_accept", 0.9, {"fit"}),
    ],
)
def test_a_key_reruns_the_stages_that_read_it(key, value, stages):
    config, other = read_config(), read_config()
    other["estimation"][key] = value
    changed = {s for s in KEYS if choose_settings(config, s) != choose_settings(other, s)}
    assert changed == stages
