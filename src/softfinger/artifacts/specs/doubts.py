"""What looks wrong in a campaign."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="doubts",
    title="What looks wrong in a campaign",
    rule="doubt",
    attrs=("campaign", "source"),
    coords={
        "doubt": Variable(("doubt",), "1", "number of the doubt", "whole number"),
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
    },
    variables={
        "kind": Variable(("doubt",), "1", "id of the kind of doubt", "text"),
        "statement": Variable(("doubt",), "1", "evidence, likely cause, what to do", "text"),
        "trial_doubted": Variable(("doubt", "trial"), "1", "whether it is doubted", "truth value"),
        "joint_doubted": Variable(("doubt", "joint"), "1", "whether it is doubted", "truth value"),
    },
)
