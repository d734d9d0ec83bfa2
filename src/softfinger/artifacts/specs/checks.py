"""Checks behind the report's claims, and their quantities."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_PAIR = ("pair",)
_CHANGE = ("change", "joint", "since_change")
_POPULATION = ("level", "parameter", "joint")
_EFFECT = ("effect_parameter",)
_SHARE = {"at_least": 0.0, "at_most": 1.0}
_WHOLE = "whole number"


def _each_check(long_name: str, kind: str = "number") -> Variable:
    return Variable(("check",), "1", long_name, kind)


def _joint(long_name: str) -> Variable:
    return Variable(("joint",), "rad", long_name, at_least=0.0)


SPEC = ArtifactSpec(
    name="checks",
    title="Checks of computation, fit and calibration",
    rule="summarise",
    attrs=("campaign", "source", "ci_prob"),
    variables={},
    groups={
        "checks": {
            "value": _each_check("what was found; NaN where the check could not be made"),
            "lower": _each_check("limit that it must exceed; -inf: none"),
            "upper": _each_check("limit that it must not exceed; inf: none"),
            "passed": _each_check("1 passed, 0 failed, -1 not made", _WHOLE),
            "joint": _each_check("the worst joint; 0 where it is of no joint", _WHOLE),
            "trials": _each_check("trials beyond the limit", _WHOLE),
            "powered": _each_check("whether it could have failed on either side", "truth value"),
            "remark": _each_check("why it could not be made, or what else counts", "text"),
        },
        "sampling": {
            "worst_quantity": Variable((), "1", "hyperparameter of the largest R-hat", "text"),
            "worst_draws": Variable(("chain", "draw"), "1", "its draws, in sd from the mean"),
            "running_mean": Variable(("chain", "draw"), "1", "mean of its draws so far"),
        },
        "residuals": {
            "n_segments": Variable(("change",), "1", "stretches after a change of load", _WHOLE),
            "mean_residual": Variable(_CHANGE, "rad", "mean of recording minus model"),
            "residual_se": Variable(_CHANGE, "rad", "its standard error", at_least=0.0),
            "residual_power": Variable(
                ("change", "joint", "frequency"), "rad2", "frequency times power", at_least=0.0
            ),
            "peak_frequency": Variable(("change", "joint"), "Hz", "of a ring; NaN: none"),
            "rings": Variable(("ring",), "Hz", "each ring once", at_least=0.0),
            "residual_rms": _joint("recording minus model, all trials"),
            "noise_mean": _joint("noise by the fit, posterior mean"),
            "noise_sd": _joint("its posterior sd"),
            "noise_declared": Variable((), "rad", "noise that the campaign declares; NaN: none"),
            "detectable": Variable((), "rad", "shared motion that would fail its check"),
            "largest_mean": _joint("largest mean residual"),
            "largest_share": Variable((), "1", "largest mean residual over the recorded range"),
        },
        "prior_predictive": {
            "joint_angle_quantile": Variable(
                ("quantile", "joint", "time"), "rad", "quantile of a new trial by the priors"
            ),
            "recorded_low": Variable(("joint", "time"), "rad", "lowest recorded angle"),
            "recorded_high": Variable(("joint", "time"), "rad", "highest recorded angle"),
            "load": Variable((), "N m", "largest load; for a command, its own unit"),
        },
        "calibration": {
            "coverage": Variable(("window", "joint"), "1", "pooled over protocols", **_SHARE),
            "expected_error": Variable(
                (), "1", "bound of the standard error if the claim is true", at_least=0.0
            ),
            "claimed": Variable((), "1", "probability of the band", **_SHARE),
            "protocol_load": Variable(
                ("protocol",), "N m", "median of the largest load; for a command, its own unit"
            ),
            "protocol_trials": Variable(("protocol",), "1", "recorded trials", _WHOLE),
        },
        "loo_pit": {
            "mean_share": Variable(("joint", "moment"), "1", "mean share below", **_SHARE),
            "p_value": Variable(("joint", "moment"), "1", "p of uniformity", **_SHARE),
            "time": Variable(("moment",), "s", "median over trials"),
            "smallest_p": Variable((), "1", "corrected for the number of tests", **_SHARE),
            "doubted": Variable((), "1", "whether it is below 0.05", "truth value"),
        },
        "independence": {
            "one": Variable(_PAIR, "1", "a trial's own parameter", "text"),
            "other": Variable(_PAIR, "1", "another one", "text"),
            "mean_product": Variable(_PAIR, "1", "mean product of standardised parameters"),
            "p_value": Variable(_PAIR, "1", "two-sided p of independence", **_SHARE),
            "smallest_p": Variable((), "1", "corrected for the number of pairs", **_SHARE),
            "doubted": Variable((), "1", "whether it is below 0.05", "truth value"),
        },
        "prior_sensitivity": {
            "prior": Variable(_POPULATION, "1", "power-scaling sensitivity to the prior"),
            "likelihood": Variable(_POPULATION, "1", "… to the recordings"),
            "reading": Variable(_POPULATION, "1", "what the pair means", "text"),
            "effect_prior": Variable(_EFFECT, "1", "power-scaling sensitivity to the prior"),
            "effect_likelihood": Variable(_EFFECT, "1", "… to the recordings"),
            "effect_reading": Variable(_EFFECT, "1", "what the pair means", "text"),
        },
    },
    optional_groups=frozenset(
        {
            "sampling",
            "residuals",
            "prior_predictive",
            "calibration",
            "loo_pit",
            "independence",
            "prior_sensitivity",
        }
    ),
)
