"""Bands of the joint angle over time, and recordings."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_MODEL = ("estimate", "protocol", "joint", "time")
_RECORDED = ("protocol", "joint", "time")
_SCORE = ("estimate", "protocol", "window", "joint")


def _angle(dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(dims, "rad", long_name, compress=True)


SPEC = ArtifactSpec(
    name="bands",
    title="Bands of the joint angle, model beside recording",
    rule="propagate",
    attrs=("bands_are", "truncation"),
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "time": Variable(("time",), "s", "time of the recording"),
        "estimate": Variable(("estimate",), "1", "two_stage or posterior", "text"),
        "protocol": Variable(("protocol",), "1", "trials with one load history", "text"),
        "window": Variable(("window",), "1", "part of the trial that is scored", "text"),
        "quantile": Variable(("quantile",), "1", "probability below"),
        "ci_prob": Variable(("ci_prob",), "1", "probability of the central band"),
        "bound": Variable(("bound",), "1", "lower or upper bound of a 90 % interval", "text"),
    },
    variables={
        "joint_angle_mean": _angle(_MODEL, "mean of a new trial's angle"),
        "joint_angle_sd": _angle(_MODEL, "standard deviation of a new trial's angle"),
        "joint_angle_quantile": _angle((*_MODEL, "quantile"), "quantile of a new trial's angle"),
        "predicted_quantile": _angle(
            (*_MODEL, "quantile"), "quantile of a new trial's recording, noise included"
        ),
        "joint_angle_mean_bound": _angle(
            (*_RECORDED, "bound"), "bound of the mean over the posterior's draws"
        ),
        "joint_angle_sd_bound": _angle(
            (*_RECORDED, "bound"), "bound of the standard deviation over the posterior's draws"
        ),
        "recorded_mean": _angle(_RECORDED, "mean over the recorded trials"),
        "recorded_sd": _angle(_RECORDED, "standard deviation over the recorded trials"),
        "recorded_quantile": _angle((*_RECORDED, "quantile"), "quantile over the recorded trials"),
        "recorded_n": Variable(_RECORDED, "1", "number of recorded trials", "whole number"),
        "coverage": Variable(
            (*_SCORE, "ci_prob"),
            "1",
            "share of frames inside the band, averaged over trials",
            at_least=0.0,
            at_most=1.0,
        ),
        "coverage_bound": Variable(
            (*_SCORE, "ci_prob", "bound"),
            "1",
            "its bound by bootstrap over trials",
            at_least=0.0,
            at_most=1.0,
        ),
        "crps": Variable(_SCORE, "rad", "continuous ranked probability score", at_least=0.0),
        "protocol_of_trial": Variable(("trial",), "1", "protocol of the trial", "text"),
    },
)
