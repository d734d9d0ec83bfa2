"""What a log that errs makes of the motion is no hum."""

from types import SimpleNamespace

import numpy as np

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mismatch.checks.hums import hear_hums
from softfinger.mismatch.posed import Posed, mend_hums

UNKNOWN = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}
LEVELS = np.array([0.0, 0.02, 0.04, 0.03, 0.05, 0.03, 0.02, 0.04, 0.01])


def record_staircase():
    """Record 6 trials of eight levels, each of which the log reads 0.6 % wrong."""
    rng, names = np.random.default_rng(15), [f"t{i}" for i in range(6)]
    at = np.repeat(np.append(0.0, 1.0 + 3.0 * np.arange(9)), 2)[1:-1]
    time, load = np.append(0.0, at[1:]), np.repeat(LEVELS, 2)[: len(at)]
    recording = build_recording(
        np.arange(375) / 15, np.tile(time, (6, 1)), np.tile(load, (6, 1)), 1, names
    )
    own = draw_parameters(
        np.array([[-2.4, -3.6, 2.9, 0.02]]), np.array([0.2, 0.4, 0.7, 0.01]), recording, rng
    )
    angles = draw_angles(recording, own, describe_noise(np.full(1, 0.003), np.zeros(1), 0.0), rng)
    scatter = 1.0 + 0.006 * np.repeat(rng.standard_normal((6, len(LEVELS))), 2, axis=1)
    return angles.assign(
        load_torque=(("trial", "knot"), load * scatter[:, : len(load)]),
        started_at=("trial", np.full(6, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )


def test_levels_that_the_log_reads_wrong_are_no_hum():
    angles = record_staircase()
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    assert hear_hums(problem, base, angles)  # what they make of the motion is as slow as a wave
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    posed = Posed(angles, problem, base, survey, {}, MeasurementEntry())
    same, hums = mend_hums(posed, lambda mended, known: posed._replace(mended=mended, known=known))
    assert hums == []
    assert same is posed
