"""What a protocol could show of each effect."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="masking",
    title="What the protocol could show of each effect",
    rule="diagnose",
    attrs=("campaign", "source"),
    coords={
        "effect": Variable(("effect",), "1", "id of the effect", "text"),
        "other_effect": Variable(("other_effect",), "1", "id of the effect", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "parameter": Variable(("parameter",), "1", "population mean", "text"),
    },
    variables={
        "signal": Variable(
            ("effect",), "1", "change of all angles over the noise, at twice the prior sd"
        ),
        "share_left": Variable(
            ("effect",),
            "1",
            "share of the signal left after refitting the base model: the masking index",
            at_least=0.0,
            at_most=1.0 + 1e-6,
        ),
        "expected_gain": Variable(("effect",), "1", "log evidence [nats] to expect"),
        "bias": Variable(
            ("effect", "joint", "parameter"),
            "1",
            "what ignoring the effect adds to the population mean (q_ini in rad)",
        ),
        "likeness": Variable(
            ("effect", "other_effect"), "1", "cosine of what is left", at_least=-1.01, at_most=1.01
        ),
    },
)
