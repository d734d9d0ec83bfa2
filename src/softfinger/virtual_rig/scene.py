"""Where the finger's parts are in the picture.

The base direction is the picture's x axis. Joint angles are relative to the link before and
counter-clockwise positive in the picture with y up, so rising angles move marks to smaller pixel
rows. The centre of the top-left pixel is (0, 0).
"""

import numpy as np
import xarray as xr

from softfinger.virtual_rig.config import SceneConfig

FRAME_WIDTH_PX = 640
FRAME_HEIGHT_PX = 480
# Low and left: a finger bent by up to 3 rad in all still lies inside the picture.
FIRST_JOINT_PX = (212.4, 371.3)
BASE_MARKERS_M = (-0.018, -0.006)
BASE_BODY_M = (-0.036, -0.008)
BASE_HALF_WIDTH_M = 0.0055
LINK_MARKERS = (0.24, 0.76)  # shares of the link's length


def build_marker_places(config: SceneConfig) -> dict[str, list[float]]:
    """Build the places of the marks [m].

    They lie along each link from its proximal joint, base first.

    The base's are measured from the first joint, so they are negative.
    """
    places = {"base": list(BASE_MARKERS_M)}
    for number, length in enumerate(config.link_length_m, start=1):
        places[f"link_{number}"] = [round(share * length, 6) for share in LINK_MARKERS]
    return places


def compute_joint_position_array(joint_angle: np.ndarray, link_length: np.ndarray) -> np.ndarray:
    """Compute the proximal end of each link.

    p_1 = 0, p_{i+1} = p_i + l_i (cos φ_i, sin φ_i), with φ_i = Σ_{j≤i} q_j.

    Parameters
    ----------
    joint_angle : (..., joint) [rad]
        Relative angles, base to tip.
    link_length : (joint,) [m]

    Returns
    -------
    (..., joint, axis) [m]
        x along the base, y up.

    Examples
    --------
    >>> compute_joint_position_array(np.array([np.pi / 2, 0.3]), np.array([2.0, 1.0])).round(9)
    array([[0., 0.],
           [0., 2.]])
    """
    direction = np.cumsum(joint_angle, axis=-1)
    step = link_length[:, None] * np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    return np.cumsum(step, axis=-2) - step


def compute_place_array(
    joint_angle: np.ndarray, link_length: np.ndarray, place: np.ndarray
) -> np.ndarray:
    """Compute places on each link [m].

    They are p_i + s (cos φ_i, sin φ_i).

    Parameters
    ----------
    joint_angle : (..., joint) [rad]
    link_length : (joint,) [m]
    place : (joint, k) [m]
        Distances s from the link's proximal joint.

    Returns
    -------
    (..., joint, k, axis) [m]
    """
    direction = np.cumsum(joint_angle, axis=-1)[..., None]
    unit = np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    return (
        compute_joint_position_array(joint_angle, link_length)[..., None, :]
        + place[..., None] * unit
    )


def convert_to_pixels_array(position: np.ndarray, metres_per_pixel: float) -> np.ndarray:
    """Positions (..., axis): metres, y up, to pixels."""
    return np.array(FIRST_JOINT_PX) + position * np.array([1.0, -1.0]) / metres_per_pixel


def compute_marker_position(joint_angle: xr.DataArray, config: SceneConfig) -> xr.DataArray:
    """Compute where the marks' centres are in the picture.

    Parameters
    ----------
    joint_angle : DataArray (..., joint) [rad]
    config
        Link lengths and the camera's scale.

    Returns
    -------
    DataArray (..., marker, axis) [px]
        Markers in the order base_1, base_2, link_1_1, link_1_2, …; axis "x", "y".
    """
    places = build_marker_places(config)
    angle = joint_angle.transpose(..., "joint")
    on_links = compute_place_array(
        angle.values,
        np.array(config.link_length_m),
        np.array([places[link] for link in places if link != "base"]),
    )
    leading = angle.shape[:-1]
    on_base = np.zeros((*leading, len(places["base"]), 2))
    on_base[..., 0] = places["base"]
    position = np.concatenate([on_base, on_links.reshape(*leading, -1, 2)], axis=-2)
    return xr.DataArray(
        convert_to_pixels_array(position, config.metres_per_pixel),
        dims=(*angle.dims[:-1], "marker", "axis"),
        coords={name: angle.coords[name] for name in angle.dims[:-1] if name in angle.coords}
        | {
            "marker": [f"{link}_{i}" for link in places for i in range(1, len(places[link]) + 1)],
            "axis": ["x", "y"],
        },
        name="marker_position",
    )


def compute_capsules(joint_angle: np.ndarray, config: SceneConfig) -> np.ndarray:
    """Compute the finger's outline as thick lines.

    The lines have round ends.

    A slender one through each joint (the constriction) and a stout one along each link.

    Parameters
    ----------
    joint_angle : (frame, joint) [rad]

    Returns
    -------
    (frame, capsule, 5) [px]
        x and y of the two ends, half thickness.
    """
    length = np.array(config.link_length_m)
    half_joint = config.joint_length_m / 2
    link_end = np.stack([np.full_like(length, half_joint), length - half_joint], axis=-1)
    links = compute_place_array(joint_angle, length, link_end)
    before = np.concatenate([np.zeros_like(joint_angle[:, :1]), joint_angle[:, :-1]], axis=1)
    centre = compute_joint_position_array(joint_angle, length)
    direction = np.cumsum(before, axis=-1)[..., None]
    proximal = centre - half_joint * np.concatenate([np.cos(direction), np.sin(direction)], axis=-1)
    joints = np.stack([proximal, links[..., 0, :]], axis=-2)
    # ASSUME: half a link is 0.95 of a mark's diameter thick, so that marks keep clear of its edge
    half_link_px = 0.95 * config.marker_diameter_m / config.metres_per_pixel
    return np.concatenate(
        [
            _build_capsules(joints, 0.5 * half_link_px, config.metres_per_pixel),
            _build_capsules(links, half_link_px, config.metres_per_pixel),
        ],
        axis=1,
    )


def compute_base_capsule(config: SceneConfig) -> np.ndarray:
    """The base's one capsule (1, 5) [px]."""
    ends = np.array([[[[place, 0.0] for place in BASE_BODY_M]]])
    half_thickness = BASE_HALF_WIDTH_M / config.metres_per_pixel
    return _build_capsules(ends, half_thickness, config.metres_per_pixel)[0]


def _build_capsules(ends: np.ndarray, half_thickness: float, metres_per_pixel: float) -> np.ndarray:
    pixels = convert_to_pixels_array(ends, metres_per_pixel).reshape(*ends.shape[:2], 4)
    return np.concatenate([pixels, np.full((*ends.shape[:2], 1), half_thickness)], axis=-1)
