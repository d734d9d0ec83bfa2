"""Numbers for tables and figures."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_OF = ("statistic", "parameter", "joint")
_CELL = ("joint", "parameter")
_PAIR = ("pair",)
_SHARE = {"at_least": 0.0, "at_most": 1.0}
_WHOLE, _TRUTH = "whole number", "truth value"


def _trial(units: str, long_name: str, kind: str = "number", **bounds: float) -> Variable:
    return Variable(("trial",), units, long_name, kind, **bounds)


def _pairs(first: str) -> dict[str, Variable]:
    return {
        "one": Variable(_PAIR, "1", first, "text"),
        "other": Variable(_PAIR, "1", "another one", "text"),
        "correlation": Variable(("pair", "quantile"), "1", "correlation over trials"),
        "clear": Variable(_PAIR, "1", "whether the interval excludes 0", _TRUTH),
        "by_chance": Variable((), "1", "pairs that chance alone would make clear", at_least=0.0),
    }


SPEC = ArtifactSpec(
    name="summary",
    title="Recordings, population and diagnosis in short",
    rule="summarise",
    # `note`: what the fit leaves open, and what its noise includes; empty where nothing is.
    attrs=("campaign", "source", "ci_prob", "note"),
    variables={},
    groups={
        "recordings": {
            "trial_duration": _trial("s", "time of its last frame"),
            "trial_frames": _trial("1", "its frames", _WHOLE),
            "trial_load": _trial("N m", "its largest load; for a command, its own unit"),
            "trial_flagged": _trial("1", "share of its angles that carry a flag", **_SHARE),
            "flag_share": Variable(("flag",), "1", "share of all angles with the flag", **_SHARE),
            "frame_interval": Variable((), "s", "median between frames"),
            "duration": Variable((), "s", "longest trial, the last frame's interval included"),
            "angle_range": Variable((), "rad", "largest less smallest recorded angle"),
            "frames": Variable((), "1", "frames of all trials", _WHOLE),
            "one_load": Variable((), "1", "whether every trial has one constant load", _TRUTH),
            "spread_error": Variable(
                (), "1", "least relative error of a spread from so few trials; NaN: one trial"
            ),
        },
        "tracking": {
            "share_seen": _trial("1", "frames in which the worst marker is seen", **_SHARE),
            "share_suspect": _trial("1", "frames in which a marker is in doubt", **_SHARE),
            "share_stale": _trial("1", "repeated frames", **_SHARE),
            "sd": _trial("px", "largest of the markers' median sd"),
            "rigid_residual": _trial("px", "largest wander of a marker on its link"),
        },
        "noise": {
            "gross_share": _trial("1", "frames left out as gross errors", **_SHARE),
            "repeated_share": _trial("1", "frames that repeat the one before", **_SHARE),
            "saturated_share": _trial("1", "frames at or after a limit of a sensor", **_SHARE),
            "noise_ratio": Variable(
                ("trial", "joint"), "1", "sd of the noise over the campaign's", at_least=0.0
            ),
            "grown_sd": Variable(
                ("deflection", "joint"), "rad", "sd of the noise at a deflection", at_least=0.0
            ),
            "fast_sd": Variable(
                ("speed", "joint"), "rad", "sd of the noise at a speed", at_least=0.0
            ),
        },
        "pictured": {
            "trial": Variable((), "1", "trial that the tracking's figure shows", "text"),
            "frame": Variable((), "1", "its frame", _WHOLE),
            "sd": Variable((), "px", "median sd of a coordinate in that trial"),
        },
        "population": {
            "quantile_value": Variable(
                ("quantile", *_OF), "1", "of mu or sigma, of the log but for q_ini"
            ),
            "sd": Variable(_OF, "1", "posterior sd of mu or sigma", at_least=0.0),
            "centre": Variable(("parameter", "joint"), "1", "median over trials, own scale"),
            "centre_sd": Variable(("parameter", "joint"), "1", "its posterior sd", at_least=0.0),
            "centre_quantile": Variable(("quantile", "parameter", "joint"), "1", "its quantile"),
            "unsure": Variable(
                ("parameter", "joint"), "1", "whether the spread is hardly determined", _TRUTH
            ),
            "rival_value": Variable(
                ("rival", *_OF), "1", "mu or sigma by another estimate", optional=True
            ),
            "rival_centre": Variable(
                ("rival", "parameter", "joint"), "1", "its centre, own scale", optional=True
            ),
        },
        "effects": {
            "effect_mean": Variable(("effect_parameter",), "1", "posterior mean, own unit"),
            "effect_sd": Variable(("effect_parameter",), "1", "its posterior sd", at_least=0.0),
            "effect_quantile": Variable(("quantile", "effect_parameter"), "1", "its quantile"),
        },
        "correlations": _pairs("a trial's own parameter"),
        "histograms": {
            "bar_edge": Variable((*_CELL, "edge"), "1", "edge of a bar, own scale"),
            "kept_density": Variable((*_CELL, "bar"), "1", "estimates that are kept, per ln unit"),
            "dropped_density": Variable((*_CELL, "bar"), "1", "estimates that are dropped"),
            "abscissa": Variable((*_CELL, "place"), "1", "abscissa of the curves"),
            "two_stage_density": Variable((*_CELL, "place"), "1", "two-stage population"),
            "posterior_density": Variable((*_CELL, "place", "quantile"), "1", "its quantile"),
            "dropped": Variable(_CELL, "1", "estimates that the rule drops", _WHOLE),
            "estimates": Variable(_CELL, "1", "all estimates", _WHOLE),
        },
        "causes": {
            "cause": Variable(("joint",), "1", "parameter that causes most of the spread", "text"),
            "share": Variable(("joint",), "1", "of the variance, alone", **_SHARE),
            "widest": Variable(("joint",), "s", "time of the widest spread"),
        },
        "pairs": {
            "pair_joint": Variable(_PAIR, "1", "number of the joint", _WHOLE),
            **_pairs("parameter"),
        },
        "misfit": {
            "mean_square": Variable(
                ("model", "joint", "since_change"), "1", "squared residual over noise"
            ),
            "trial_base": Variable((), "1", "trial of which the base leaves most", "text"),
            "trial_final": Variable((), "1", "trial that the repair helps most", "text"),
            "like_base": _trial("1", "whether it has the load of trial_base", _TRUTH),
            "like_final": _trial("1", "whether it has the load of trial_final", _TRUTH),
        },
        "evidence": {
            "needed": Variable(("effect",), "1", "whether it is needed beside all others", _TRUTH),
            "sentence": Variable(("effect",), "1", "what happens", "text"),
            "refused_sentence": Variable(("refused_effect",), "1", "what happens", "text"),
            "unfitted_sentence": Variable(("unfitted_effect",), "1", "what happens", "text"),
            "chance_range": Variable(("end",), "1", "least and largest gain by chance [nats]"),
        },
        "location": {
            "shows": Variable(("joint",), "1", "whether the misfit shows there", _TRUTH),
            "line_shows": Variable((), "1", "whether a spectral line shows", _TRUTH),
        },
        "assumptions": {
            "fitted_change": Variable(
                ("quantile", *_CELL), "1", "fitted over true, less 1, over simulated fingers"
            ),
        },
    },
    optional_groups=frozenset(
        {
            "tracking",
            "pictured",
            "population",
            "effects",
            "correlations",
            "histograms",
            "causes",
            "pairs",
            "misfit",
            "evidence",
            "location",
            "assumptions",
            "noise",
        }
    ),
)
