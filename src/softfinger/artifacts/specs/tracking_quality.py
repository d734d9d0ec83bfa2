"""Tracking quality of each filmed trial's markers."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

EACH = ("trial", "marker")

SPEC = ArtifactSpec(
    name="tracking_quality",
    title="How well each trial was tracked",
    rule="tracking_quality",
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "marker": Variable(("marker",), "1", "name of the marker, base first", "text"),
    },
    variables={
        "share_seen": Variable(
            EACH, "1", "share of the frames that show it", at_least=0, at_most=1
        ),
        "share_suspect": Variable(
            EACH, "1", "share of the frames in which it is in doubt", at_least=0, at_most=1
        ),
        "share_stale": Variable(
            ("trial",), "1", "share of the frames that the camera repeated", at_least=0, at_most=1
        ),
        "sd_median": Variable(EACH, "px", "median of its claimed standard deviation", at_least=0),
        "rigid_residual": Variable(EACH, "px", "rms by which it wanders on its link", at_least=0),
    },
)
