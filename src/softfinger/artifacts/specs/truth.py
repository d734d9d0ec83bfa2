"""What the virtual rig did; for tests only."""

from softfinger.artifacts.spec import ArtifactSpec, Variable


def _per_trial(units: str, long_name: str) -> Variable:
    return Variable(("trial", "joint"), units, long_name)


def _per_population(long_name: str) -> Variable:
    text = f"{long_name} of the logarithm of k_v, c_v, c_p and of q_ini [rad] itself"
    return Variable(("joint", "parameter"), "1", text)


SPEC = ArtifactSpec(
    name="truth",
    title="True motion and parameters of a simulated campaign",
    rule="virtual_rig",
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(("parameter",), "1", "k_v, c_v, c_p, q_ini", "text"),
        "time": Variable(("frame",), "s", "time of the frame"),
    },
    variables={
        "k_v": _per_trial("N m/rad", "stiffness of the Kelvin–Voigt element"),
        "c_v": _per_trial("N m s/rad", "damping of the Kelvin–Voigt element"),
        "c_p": _per_trial("N m s/rad", "damping of the dashpot in series"),
        "q_ini": _per_trial("rad", "joint angle before the load"),
        "joint_angle": Variable(
            ("trial", "joint", "frame"), "rad", "relative joint angle, without noise"
        ),
        "load_time": Variable(("knot",), "s", "knot of the load"),
        "load_tension": Variable(("knot",), "N", "tension of the flexion wire", at_least=0.0),
        "population_mean": _per_population("mean"),
        "population_sd": _per_population("standard deviation"),
    },
)
