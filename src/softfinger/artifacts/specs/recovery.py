"""Both fits against a simulated campaign's known truth."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_POPULATION = ("statistic", "joint", "parameter")
_TRIAL = ("estimate", "joint", "parameter")
_SCALE = "of the log of k_v, c_v, c_p and of q_ini [rad] itself"

SPEC = ArtifactSpec(
    name="recovery",
    title="Two-stage estimate and posterior against the truth of a simulated campaign",
    rule="recovery",
    coords={
        "estimate": Variable(("estimate",), "1", "two_stage or posterior", "text"),
        "reference": Variable(
            ("reference",), "1", "the population drawn from, or the trials drawn", "text"
        ),
        "statistic": Variable(("statistic",), "1", "mu or sigma", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(("parameter",), "1", "k_v, c_v, c_p, q_ini", "text"),
        "ci_prob": Variable(("ci_prob",), "1", "probability of the central interval"),
    },
    variables={
        "true_value": Variable(("reference", *_POPULATION), "1", f"mean and sd {_SCALE}"),
        "value": Variable(("estimate", *_POPULATION), "1", f"estimated mean and sd {_SCALE}"),
        "value_sd": Variable(
            ("estimate", *_POPULATION), "1", "standard deviation of the estimate", at_least=0.0
        ),
        "error_in_sd": Variable(
            ("estimate", *_POPULATION), "1", "error against the population over the estimate's sd"
        ),
        "relative_error": Variable(
            ("estimate", "reference", *_POPULATION), "1", "estimated over true, less 1"
        ),
        "inside": Variable(
            ("estimate", *_POPULATION, "ci_prob"),
            "1",
            "whether the interval contains the population's value",
            at_least=0.0,
            at_most=1.0,
        ),
        "trial_coverage": Variable(
            (*_TRIAL, "ci_prob"),
            "1",
            "share of trials whose interval contains their own parameter",
            at_least=0.0,
            at_most=1.0,
        ),
        "trial_n": Variable(_TRIAL, "1", "trials that have such an interval", "whole number"),
        "trial_error": Variable(
            _TRIAL, "1", "median over trials of |estimated over true, less 1|", at_least=0.0
        ),
    },
)
