"""The shape of what no listed effect explains."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="free_form",
    title="Shape of what no listed effect explains",
    rule="diagnose",
    attrs=("campaign", "source", "argument", "gain_nats"),
    coords={
        "quantity": Variable(("quantity",), "1", "what it adds to, with its joint", "text"),
        "place": Variable(("place",), "1", "value of the argument, in the argument's unit"),
    },
    variables={
        "value": Variable(
            ("quantity", "place"), "1", "what is added: rad to an angle, 1 to a logarithm"
        ),
        "sd": Variable(("quantity", "place"), "1", "its posterior sd", at_least=0.0),
        "elpd_difference": Variable(
            (), "1", "leave-one-trial-out log score [nats] that it adds; NaN for a single trial"
        ),
        "elpd_se": Variable((), "1", "its standard error [nats]", at_least=0.0),
        "excess": Variable(
            (), "1", "mean square within trials over that of the noise, less 1, with the shape"
        ),
        "excess_without": Variable((), "1", "the same without the shape"),
    },
)
