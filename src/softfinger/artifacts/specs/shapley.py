"""Shapley effects of correlated parameters on the angle."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_SERIES = ("joint", "time", "parameter")
_PAIR = ("joint", "parameter", "other_parameter")
# Rounding: an effect is a ratio of quadratures.
_SHARE = {"at_least": -1e-6, "at_most": 1.0 + 1e-6, "compress": True}
_WITHIN = {"at_least": -1.0 - 1e-9, "at_most": 1.0 + 1e-9}

SPEC = ArtifactSpec(
    name="shapley",
    title="Shapley effects of correlated parameters over time",
    rule="shapley",
    attrs=("definition", "protocol"),
    coords={
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "time": Variable(("time",), "s", "time since the start of the protocol"),
        "parameter": Variable(("parameter",), "1", "parameter that varies", "text"),
        "other_parameter": Variable(
            ("other_parameter",), "1", "parameter that goes with it", "text"
        ),
        "quantile": Variable(("quantile",), "1", "quantile over the posterior's draws"),
    },
    variables={
        "shapley": Variable(_SERIES, "1", "Shapley effect, mean over draws", **_SHARE),
        "shapley_quantile": Variable((*_SERIES, "quantile"), "1", "its quantile", **_SHARE),
        "correlation": Variable(
            _PAIR, "1", "correlation between trials, mean over draws", **_WITHIN
        ),
        "correlation_quantile": Variable((*_PAIR, "quantile"), "1", "its quantile", **_WITHIN),
    },
)
