"""Parameters, residuals and predictions before and after the repair."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_MEAN = ("model", "joint", "parameter")
_ANGLE = ("trial", "joint", "bin")
_SHARE = {"at_least": 0.0, "at_most": 1.0}

SPEC = ArtifactSpec(
    name="repair",
    title="The fit before and after the repair",
    rule="diagnose",
    attrs=("campaign", "source", "decision", "effects", "load_unit"),
    coords={
        "model": Variable(("model",), "1", "base or final", "text"),
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(
            ("parameter",), "1", "log_k_v, log_c_v, log_c_p, q_ini [rad]", "text"
        ),
        "ci_prob": Variable(("ci_prob",), "1", "probability of the central band"),
        "level": Variable(("level",), "1", "largest load of the trials that were left out"),
        "bound": Variable(("bound",), "1", "of the 90 % interval", "text"),
        "quantile": Variable(("quantile",), "1", "probability below"),
    },
    variables={
        "population_mean": Variable(_MEAN, "1", "mean over trials"),
        "population_mean_sd": Variable(_MEAN, "1", "its posterior sd", at_least=0.0),
        "population_sd": Variable(_MEAN, "1", "sd between trials", at_least=0.0),
        "bias": Variable(
            ("joint", "parameter"), "1", "base minus final mean: what the omission added"
        ),
        "explained_spread": Variable(
            ("joint", "parameter"), "1", "share of the variance between trials that was physics"
        ),
        "elpd": Variable(
            ("model", "trial"),
            "1",
            "log density [nats] of the trial given the others; NaN for a single trial",
        ),
        "residual_rms": Variable(
            ("model", "trial", "joint"), "rad", "residual at the trial's own mode", at_least=0.0
        ),
        "noise_sd": Variable(("joint",), "rad", "of the noise, without a model", at_least=0.0),
        "time": Variable(("trial", "bin"), "s", "mean time of the bin; NaN after the last one"),
        "since_change": Variable(("trial", "bin"), "s", "since the last change of load"),
        "load": Variable(("trial", "bin"), "N m", "load; for a command, its own unit"),
        "recorded_angle": Variable(_ANGLE, "rad", "mean angle of the bin", compress=True),
        "fitted_angle": Variable(
            ("model", *_ANGLE), "rad", "the model at the trial's own mode", compress=True
        ),
        "predicted_quantile": Variable(
            ("model", "quantile", *_ANGLE),
            "rad",
            "quantile of a new trial's angle, by the other trials; NaN for a single trial",
            compress=True,
        ),
        "bin_noise_sd": Variable(
            _ANGLE, "rad", "sd of the bin's noise", at_least=0.0, compress=True
        ),
        "coverage": Variable(
            ("model", "joint", "ci_prob"),
            "1",
            "share of the recorded angles inside the band that the other trials predict",
            **_SHARE,
        ),
        "coverage_bound": Variable(
            ("model", "joint", "ci_prob", "bound"), "1", "by bootstrap over trials", **_SHARE
        ),
        "level_error": Variable(
            ("model", "level", "joint"),
            "rad",
            "rms of mean recorded minus mean predicted angle, fitted without that level",
            at_least=0.0,
        ),
        "level_coverage": Variable(
            ("model", "level", "joint"), "1", "of the 90 % band of that prediction", **_SHARE
        ),
        "level_n_trials": Variable(("level",), "1", "trials of that level", "whole number"),
    },
)
