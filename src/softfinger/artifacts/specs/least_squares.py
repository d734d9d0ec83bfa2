"""The paper's two stages: trial estimates and their distributions."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_DIMS = ("trial", "joint", "parameter")
_OWN = "1"  # k_v [N m/rad], c_v and c_p [N m s/rad], q_ini [rad] are side by side

SPEC = ArtifactSpec(
    name="least_squares",
    title="Least-squares estimates of every trial, and the population over them",
    rule="least_squares",
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(
            ("parameter",), "1", "k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad]", "text"
        ),
    },
    variables={
        "estimate": Variable(_DIMS, _OWN, "least-squares estimate, in the parameter's own unit"),
        "estimate_sd": Variable(
            _DIMS, _OWN, "its standard deviation under white noise", at_least=0.0
        ),
        "kept": Variable(_DIMS, "1", "whether the paper's rule keeps it", "truth value"),
        "residual_rms": Variable(
            ("trial", "joint"), "rad", "root mean square of the residual", at_least=0.0
        ),
        "population_mean": Variable(
            ("joint", "parameter"), "1", "mean over kept trials, of the log but for q_ini"
        ),
        "population_sd": Variable(
            ("joint", "parameter"),
            "1",
            "sd over kept trials, of the log but for q_ini",
            at_least=0.0,
        ),
    },
)
