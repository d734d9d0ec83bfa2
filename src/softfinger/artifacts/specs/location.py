"""Where base and repaired model miss."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_CELL = ("model", "joint", "phase", "window")
_BETWEEN = ("model", "joint", "parameter", "covariate")
_P = {"at_least": 0.0, "at_most": 1.0}

SPEC = ArtifactSpec(
    name="location",
    title="Where a model misses the recordings",
    rule="diagnose",
    attrs=("campaign", "source"),
    coords={
        "model": Variable(("model",), "1", "base or final", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "phase": Variable(("phase",), "1", "what the load does", "text"),
        "window": Variable(("window",), "s", "start of the time since the last change of load"),
        "parameter": Variable(("parameter",), "1", "a trial's own parameter", "text"),
        "covariate": Variable(("covariate",), "1", "what differs between trials", "text"),
    },
    variables={
        "mean_square": Variable(
            _CELL, "1", "mean square of whitened residuals; 1 = noise alone", at_least=0.0
        ),
        "mean": Variable(_CELL, "1", "mean of whitened residuals"),
        "count": Variable(_CELL, "1", "binned angles in the cell", at_least=0.0),
        "p_value": Variable(_CELL, "1", "of scatter and mean together; NaN = too few", **_P),
        "q_value": Variable(_CELL, "1", "false-discovery rate at which it counts", **_P),
        "correlation": Variable(
            _BETWEEN, "1", "rank correlation of a parameter over trials", at_least=-1, at_most=1
        ),
        "correlation_p_value": Variable(_BETWEEN, "1", "its p-value; NaN = too few", **_P),
        "correlation_q_value": Variable(
            _BETWEEN, "1", "false-discovery rate at which it counts", **_P
        ),
        "line_frequency": Variable((), "Hz", "strongest spectral line that the final model leaves"),
        "line_joint": Variable(
            (), "1", "its joint; 0: all, as the load moves them", "whole number"
        ),
        "line_p_value": Variable((), "1", "its p-value, corrected for the frequencies", **_P),
    },
)
