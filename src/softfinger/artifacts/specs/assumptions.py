"""The paper's assumptions against simulated fingers' full dynamics."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_WINDOW = ("cause", "joint", "window")
_TIME = ("cause", "joint", "time")
_FINGER = ("trial", "joint")

SPEC = ArtifactSpec(
    name="assumptions",
    title="The paper's assumptions against the full equations of motion",
    rule="assumptions",
    attrs=("tension_n", "wire_offset_m", "joint_length_m"),
    coords={
        "trial": Variable(("trial",), "1", "simulated finger", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "cause": Variable(("cause",), "1", "what the step solution leaves out", "text"),
        "time": Variable(("time",), "s", "time since the step"),
        "window_start": Variable(("window",), "s", "start of the time window"),
        "window_end": Variable(("window",), "s", "its end"),
        "angle": Variable(("angle",), "rad", "joint angle"),
        "parameter": Variable(("parameter",), "1", "fitted parameter", "text"),
    },
    variables={
        "gap_largest": Variable(_WINDOW, "rad", "largest gap over fingers", at_least=0.0),
        "gap_rms": Variable(_WINDOW, "rad", "rms gap, decades of time alike", at_least=0.0),
        "gap_largest_at": Variable(_TIME, "rad", "largest gap over fingers", at_least=0.0),
        "gap_rms_at": Variable(_TIME, "rad", "rms gap over fingers", at_least=0.0),
        "inertia_lasts": Variable(
            ("joint",), "s", "time after which inertia never moves the angle by 1 mrad"
        ),
        "arm_growth": Variable(("angle",), "1", "moment arm over wire offset, less 1"),
        "torque_growth": Variable(_FINGER, "1", "torque at the end over that at the start, less 1"),
        "angle_reached": Variable(_FINGER, "rad", "joint angle at the end"),
        "fitted_change": Variable(
            (*_FINGER, "parameter"), "1", "fitted over true, less 1; of q_ini the difference [rad]"
        ),
        "fitted_residual_rms": Variable(_FINGER, "rad", "what the fit leaves", at_least=0.0),
        "statement": Variable(("sentence",), "1", "the numbers in words", "text"),
    },
)
