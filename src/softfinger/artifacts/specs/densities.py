"""Densities of the joint angle at chosen times."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="densities",
    title="Densities of a new trial's joint angle at chosen times",
    rule="propagate",
    attrs=("protocol", "protocol_n_trials", "truncation"),
    coords={
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "time": Variable(("time",), "s", "time since the start of the protocol"),
        "estimate": Variable(("estimate",), "1", "two_stage or posterior", "text"),
        "bound": Variable(("bound",), "1", "lower or upper bound of a 90 % interval", "text"),
    },
    variables={
        "joint_angle": Variable(("joint", "time", "angle"), "rad", "angle of the density"),
        "density": Variable(
            ("estimate", "joint", "time", "angle"), "rad-1", "probability density", at_least=-1e-6
        ),
        "density_bound": Variable(
            ("joint", "time", "angle", "bound"), "rad-1", "bound over the posterior's draws"
        ),
        "density_error": Variable(
            ("joint", "time"), "1", "error of the quadrature over the peak", at_least=0.0
        ),
        "probability_shown": Variable(
            ("estimate", "joint", "time"),
            "1",
            "probability within the angles drawn",
            at_least=0.0,
            at_most=1.0 + 1e-6,
        ),
    },
)
