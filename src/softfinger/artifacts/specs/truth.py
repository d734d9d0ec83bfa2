"""What the virtual rig really did. Read by tests and calibration only."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="truth",
    title="True motion and parameters of a simulated campaign",
    rule="virtual_rig",
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(("parameter",), "1", "k_v, c_v, c_p, q_ini", "text"),
    },
    variables={},
)
