"""Figures of finger, joint model, recordings and tracking."""

from softfinger.figures.recordings import draw_recordings
from softfinger.figures.sketches import draw_finger_sketch, draw_joint_model_sketch
from softfinger.figures.tracking import draw_tracking
from softfinger.report.blocks import Picture
from softfinger.report.formatting import capital, count_things, format_number
from softfinger.report.material import Material


def picture_finger(material: Material) -> Picture:
    """The finger's geometry."""
    n_joint = material.angles["joint"].size
    wires = "tension_n" in material.angles["load_kind"].values.astype(str)
    wire_words = "; d is the distance of the wire from the middle plane" if wires else ""
    return Picture(
        "finger",
        "The finger and its angles",
        draw_finger_sketch(n_joint, wires=wires),
        f"Sketch of a finger of {count_things(n_joint, 'joint')} seen from above: a base, links "
        f"with two markers each{', the pulled wire' if wires else ''}, and each joint's angle.",
        "Sketch, drawn by code. q is each joint's angle relative to the link before, "
        f"counter-clockwise positive{wire_words}.",
    )


def picture_joint_model(material: Material) -> Picture:
    """The joint's springs and dashpots."""
    del material
    return Picture(
        "joint_model",
        "The model of one joint",
        draw_joint_model_sketch(),
        "A spring k_v beside a dashpot c_v, in series with a dashpot c_p, pulled by the torque τ.",
        "Sketch, drawn by code. The spring k_v with the dashpot c_v beside it recovers (q_v); the "
        "dashpot c_p in series flows for good (q_p).",
    )


def picture_recordings(material: Material) -> Picture:
    """All recordings."""
    angles = material.angles
    return Picture(
        "recordings",
        "What was recorded",
        draw_recordings(angles),
        f"Joint angle over time of every trial, one panel for each of {angles['joint'].size} "
        "joints, with the load below.",
        f"Every trial's motion and load; masked frames leave gaps. "
        f"n = {count_things(angles['trial'].size, 'trial')}. {capital(material.cite('angles'))}.",
    )


def picture_tracking(material: Material) -> Picture | None:
    """One frame with its markers."""
    if "markers" not in material:
        return None
    markers = material.get("markers")
    image = material.artifacts["picture"]["picture"] if "picture" in material else None
    shown = material.find("pictured")
    trial, frame, sd = (shown[name].item() for name in ("trial", "frame", "sd"))
    where = "on the picture itself" if image is not None else "without its picture"
    return Picture(
        "tracking",
        "What the tracking saw",
        draw_tracking(markers.sel(trial=trial), frame, image),
        f"Markers found in one frame of trial {trial}: rings on base and links, with their paths.",
        f"Frame {frame} of trial {trial}, {where}: rings are markers, a red cross marks a "
        f"doubtful one, thin lines are their paths over the trial. Median standard deviation of "
        f"a coordinate: {format_number(sd, 2)} px. {capital(material.cite('markers'))}.",
        true_colours=image is not None,
    )
