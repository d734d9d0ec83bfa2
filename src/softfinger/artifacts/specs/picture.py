"""One frame of the first used trial, for people."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="picture",
    title="One frame, to see the markers on",
    rule="picture",
    coords={
        "trial": Variable((), "1", "trial that was filmed", "text"),
        "frame": Variable((), "1", "number of the frame, from 0", "whole number"),
        "channel": Variable(("channel",), "1", "colour", "text"),
    },
    variables={
        "picture": Variable(
            ("row", "column", "channel"),
            "1",
            "brightness",
            "whole number",
            at_least=0,
            at_most=255,
            compress=True,
        ),
    },
)
