"""A campaign's relative joint angles, loads and covariates."""

import numpy as np

from softfinger.artifacts.spec import ArtifactSpec, Variable


def _per_joint(units: str, long_name: str) -> Variable:
    return Variable(("joint",), units, f"{long_name}; NaN = not declared", at_least=0.0)


SPEC = ArtifactSpec(
    name="angles",
    title="Relative joint angles and loads of a campaign",
    rule="angles",
    # `camera`: 1 where the motion was filmed, or a camera is declared; else 0.
    attrs=("campaign", "source", "camera", "noise_sd_rad"),
    # Of a specimen: its declared units, and what is one radian and zero in that of the motion.
    optional_attrs=(
        "motion_quantity",
        "motion_unit",
        "motion_per_rad",
        "motion_zero",
        "load_quantity",
        "load_unit",
    ),
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "other_joint": Variable(("other_joint",), "1", "number of the joint", "whole number"),
        "covariate": Variable(("covariate",), "1", "name of the covariate", "text"),
        "set_aside_trial": Variable(("set_aside_trial",), "1", "trial that is not used", "text"),
    },
    variables={
        "time": Variable(("trial", "frame"), "s", "time of the frame; NaN after the last one"),
        "joint_angle": Variable(
            ("trial", "joint", "frame"),
            "rad",
            "angle relative to the link before, positive in the direction of bending; NaN = none",
            at_least=-4 * np.pi,
            at_most=4 * np.pi,
            compress=True,
        ),
        "joint_angle_covariance": Variable(
            ("trial", "frame", "joint", "other_joint"),
            "rad2",
            "covariance of the joint angles of a frame; NaN where the recording claims none",
            compress=True,
        ),
        "angle_flag": Variable(
            ("trial", "joint", "frame"),
            "1",
            "bits: 1 missing, 2 stale frame, 4 jump",
            "whole number",
            compress=True,
        ),
        "load_time": Variable(("trial", "knot"), "s", "knot of the load; a jump has two knots"),
        "load_torque": Variable(
            ("trial", "knot"),
            "N m",
            "generalised torque on every joint in the base model; for a command, its own unit",
        ),
        "load_kind": Variable(("trial",), "1", "tension_n, torque_nm, command or assumed", "text"),
        "started_at": Variable(("trial",), "s", "start, since the first trial's; NaN = unknown"),
        "covariate_value": Variable(("trial", "covariate"), "1", "covariate, in its own unit"),
        "link_length": _per_joint("m", "joint centre to joint centre"),
        "link_mass": _per_joint("kg", "mass of the link"),
        "link_centre": _per_joint("m", "centre of mass from the proximal joint"),
        "link_inertia": _per_joint("kg m2", "moment of inertia about the centre of mass"),
        "joint_length": Variable((), "m", "length of the constricted joint; NaN = not declared"),
        "wire_offset": Variable((), "m", "wire from the middle plane; NaN = not declared"),
        "set_aside_reason": Variable(
            ("set_aside_trial",), "1", "why the trial is set aside", "text"
        ),
    },
)
