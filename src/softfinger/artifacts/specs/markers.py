"""Marker positions in a batch of trials' pictures."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="markers",
    title="Marker positions in the pictures",
    rule="track",
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "marker": Variable(("marker",), "1", "name of the marker, base first", "text"),
        "axis": Variable(("axis",), "1", "picture axis: x to the right, y down", "text"),
    },
    variables={
        "time": Variable(("trial", "frame"), "s", "time of the frame; NaN after the last one"),
        "marker_position": Variable(
            ("trial", "frame", "marker", "axis"),
            "px",
            "centre of the marker, from the centre of the top left pixel; NaN = not seen",
            at_least=-1e5,
            at_most=1e5,
            compress=True,
        ),
        "marker_position_sd": Variable(
            ("trial", "frame", "marker"),
            "px",
            "standard deviation of either coordinate",
            at_least=0.0,
            compress=True,
        ),
        "marker_flag": Variable(
            ("trial", "frame", "marker"),
            "1",
            "bits: 1 not seen, 2 stale frame, 4 suspect",
            "whole number",
            compress=True,
        ),
        "set_aside_reason": Variable(
            ("trial",), "1", "why the trial is set aside; empty = used", "text"
        ),
    },
)
