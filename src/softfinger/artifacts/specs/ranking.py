"""How well every form explains the base's misfit."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="ranking",
    title="Evidence of left-out physics",
    rule="diagnose",
    attrs=("campaign", "source", "decision"),
    coords={
        "model": Variable(("model",), "1", "effects with form and joints, best first", "text"),
        "effect_set": Variable(("effect_set",), "1", "effects joined by +", "text"),
        "effect": Variable(("effect",), "1", "id of the effect", "text"),
        "refused_effect": Variable(("refused_effect",), "1", "id of the effect", "text"),
        "replicate": Variable(("replicate",), "1", "drawn campaign", "whole number"),
    },
    variables={
        "gain": Variable(
            ("model",), "1", "log evidence over the base model [nats], own parameters integrated"
        ),
        "fitted": Variable(
            ("model",), "1", "fitted to rest; else the gain is a first estimate", "truth value"
        ),
        "model_effects": Variable(("model",), "1", "its effects joined by +", "text"),
        "set_probability": Variable(
            ("effect_set",), "1", "posterior probability", at_least=0.0, at_most=1.0 + 1e-9
        ),
        "inclusion": Variable(
            ("effect",),
            "1",
            "probability that the effect is needed",
            at_least=0.0,
            at_most=1.0 + 1e-9,
        ),
        "best_gain": Variable(("effect",), "1", "best gain [nats] with this effect alone"),
        "refused_reason": Variable(
            ("refused_effect",), "1", "why the campaign cannot show it", "text"
        ),
        "chance_gain": Variable(
            ("replicate",), "1", "largest gain [nats] over the catalogue without left-out physics"
        ),
        "needed_gain": Variable((), "1", "gain [nats] from which an effect is believed"),
    },
)
