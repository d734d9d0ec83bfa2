"""What a rig's protocols would show, before recording."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

EACH = ("protocol", "effect")

SPEC = ArtifactSpec(
    name="visibility",
    title="What protocols would show of each effect",
    rule="rig_plan",
    coords={
        "protocol": Variable(("protocol",), "1", "name of the protocol", "text"),
        "effect": Variable(("effect",), "1", "id of the effect", "text"),
    },
    variables={
        "signal": Variable(EACH, "1", "change of all angles over the noise, at twice the prior sd"),
        "share_left": Variable(
            EACH,
            "1",
            "share of the signal left after refitting the base model; NaN = cannot occur",
            at_least=0.0,
            at_most=1.0 + 1e-6,
        ),
        "expected_gain": Variable(EACH, "1", "log evidence [nats] to expect"),
        "separation": Variable(
            EACH, "1", "the same, without what looks like one of the wanted effects"
        ),
    },
)
