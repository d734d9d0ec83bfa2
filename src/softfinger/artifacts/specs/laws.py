"""The curves of a diagnosis's free laws."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="laws",
    title="Free laws of the repaired model, with their bands",
    rule="diagnose",
    attrs=("campaign", "source", "decision"),
    variables={
        "argument": Variable(
            ("law", "place"), "1", "what the law depends on, in the unit of `argument_name`"
        ),
        "value": Variable(("law", "place"), "1", "the law as it is shown, by `kind`"),
        "low": Variable(("law", "place"), "1", "its 0.05 quantile"),
        "high": Variable(("law", "place"), "1", "its 0.95 quantile"),
        "effect": Variable(("law",), "1", "id of the effect", "text"),
        "argument_name": Variable(("law",), "1", "argument, its unit as suffix", "text"),
        "kind": Variable(("law",), "1", "factor 1 + law, exponential of it, or sum", "text"),
        "joint": Variable(
            ("law",), "1", "number of the joint; 0: one law for all", "whole number", at_least=0
        ),
    },
)
