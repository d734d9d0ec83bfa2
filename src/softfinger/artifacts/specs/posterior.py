"""The hierarchical posterior of a campaign, in ArviZ's groups."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

_POPULATION = ("chain", "draw", "joint")
_TRIAL = ("chain", "draw", "trial", "joint")
_PAIR = ("own", "other_own")
_SHARE = {"at_least": 0.0, "at_most": 1.0}
_LOGS = {"k_v": "stiffness", "c_v": "damping of the Kelvin–Voigt element", "c_p": "damping of flow"}


def _describe_populations() -> dict[str, Variable]:
    declared = {}
    for name, meaning in _LOGS.items():
        text = f"log of the {meaning} [N m/rad]" if name == "k_v" else f"log of the {meaning}"
        declared[f"mu_log_{name}"] = Variable(_POPULATION, "1", f"population mean of the {text}")
        declared[f"sigma_log_{name}"] = Variable(
            _POPULATION, "1", f"population sd of the {text}", at_least=0.0
        )
        declared[f"log_{name}"] = Variable(_TRIAL, "1", f"{text} of a trial")
    return declared


SPEC = ArtifactSpec(
    name="posterior",
    title="Hierarchical posterior of the viscoelastic parameters",
    rule="fit",
    # `note`: what few trials leave open, and what the noise includes; empty where nothing is.
    attrs=("note",),
    variables={},
    groups={
        "posterior": {
            **_describe_populations(),
            "mu_q_ini": Variable(_POPULATION, "rad", "population mean of the initial angle"),
            "sigma_q_ini": Variable(
                _POPULATION, "rad", "population sd of the initial angle", at_least=0.0
            ),
            "q_ini": Variable(_TRIAL, "rad", "initial angle of a trial"),
            "parameter_correlation": Variable(
                ("chain", "draw", *_PAIR),
                "1",
                "correlation of a trial's parameters over trials",
                at_least=-1.0,
                at_most=1.0,
                optional=True,
            ),
            "noise_sd": Variable(
                _POPULATION, "rad", "marginal sd of the measurement noise", at_least=0.0
            ),
            "noise_autocorrelation": Variable(
                _POPULATION,
                "1",
                "its autocorrelation over a median frame interval",
                at_least=-1.0,
                at_most=1.0,
            ),
            "noise_white": Variable(
                _POPULATION, "1", "share of it new in every frame", at_least=0.0, at_most=1.0
            ),
        },
        "sample_stats": {
            "diverging": Variable(
                ("chain", "draw"), "1", "whether the trajectory diverged", "truth value"
            ),
            "expansion_pareto_k": Variable(
                (), "1", "Pareto k of the weights by the full model", optional=True
            ),
            "expansion_error": Variable(
                (), "1", "sd of what the expansion leaves out of a trial [nats]", optional=True
            ),
        },
        "loo_pit": {
            "pit": Variable(
                ("trial", "joint", "moment"),
                "1",
                "probability below the recorded angle, by the other trials",
                optional=True,
                **_SHARE,
            ),
            "pit_time": Variable(("trial", "moment"), "s", "time of the moment", optional=True),
            "p_value": Variable(
                ("joint", "moment"), "1", "p of uniformity over trials", optional=True, **_SHARE
            ),
            "smallest_p": Variable(
                (), "1", "smallest p, corrected for the number of tests", optional=True, **_SHARE
            ),
        },
        "independence": {
            "mean_product": Variable(
                _PAIR, "1", "mean product of standardised parameters", optional=True
            ),
            "p_value": Variable(_PAIR, "1", "two-sided p of independence", optional=True, **_SHARE),
            "smallest_p": Variable(
                (), "1", "smallest p, corrected for the number of pairs", optional=True, **_SHARE
            ),
        },
        "prior_sensitivity": {
            name: Variable(
                ("level", "parameter", "joint"),
                "1",
                f"power-scaling sensitivity to the {name}",
                at_least=0.0,
                optional=True,
            )
            for name in ("prior", "likelihood")
        }
        | {
            f"effect_{name}": Variable(
                ("effect_parameter",),
                "1",
                f"power-scaling sensitivity of the effects to the {name}",
                at_least=0.0,
                optional=True,
            )
            for name in ("prior", "likelihood")
        },
    },
)
