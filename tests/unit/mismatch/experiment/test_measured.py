"""The next experiment sees recordings as they were diagnosed."""

from pathlib import Path

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model_file import FittedTo
from softfinger.mismatch.experiment.survivors import (
    Survivor,
    describe_survivors,
    measure_uncertainty,
    read_survivors,
    write_survivors,
)
from softfinger.stages.next import pose_measured

SHA = "a" * 64


@pytest.fixture(scope="module")
def angles(draw_campaign):
    return draw_campaign(2, 0.0).isel(frame=slice(0, 100))


@pytest.fixture(scope="module")
def survivor(angles):
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    return Survivor("none", base, measure_uncertainty(problem, base), 1.0)


def keep(survivor, measurement, file):
    """Write a survivor with what its recordings suffer from, and read it."""
    fitted = FittedTo(campaign="drawn", sha256=SHA)
    write_survivors(describe_survivors([survivor], fitted, "adequate", [], measurement), file)
    return read_survivors(file, SHA)


def test_clock_and_drift_of_the_diagnosis_count(angles, survivor, tmp_path):
    known = MeasurementEntry(clock_rate=0.01, disturbances={"drift": 0.5})
    content = keep(survivor, known, tmp_path / "survivors.yaml")
    right, problem, base = pose_measured(angles, content, Path("survivors.yaml"))
    np.testing.assert_allclose(right["time"].values, 1.01 * angles["time"].values)
    assert problem.disturbed == {"drift": 0.5}
    assert base.fit is not None


def test_where_nothing_is_wrong_the_recordings_stay_as_they_are(angles, survivor, tmp_path):
    content = keep(survivor, None, tmp_path / "survivors.yaml")
    right, problem, base = pose_measured(angles, content, Path("survivors.yaml"))
    assert right.equals(angles)
    assert not problem.disturbed
    assert base.log_evidence == survivor.candidate.log_evidence
