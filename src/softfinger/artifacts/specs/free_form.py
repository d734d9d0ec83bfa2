"""The shape of what no listed effect explains; no quantity where nothing calls for one."""

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
    },
)
