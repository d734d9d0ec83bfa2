import numpy as np
import pytest
import xarray as xr

from softfinger.campaign import read_campaign
from softfinger.faults import CampaignFault, Fault
from softfinger.tracking import assemble_angles
from softfinger.tracking.dots import measure_motion
from softfinger.tracking.track import track_video

WIDTH, HEIGHT, FRAMES = 160, 120, 14
PATH = np.column_stack([np.linspace(110, 122, FRAMES), np.linspace(60, 40, FRAMES)])
STILL = np.array([40.0, 60.0])


def film(path, colours=("#000000", "#000000")):
    """Two dots on grey, one of which moves."""
    import cv2

    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"FFV1"), 10.0, (WIDTH, HEIGHT))
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    for moving in PATH:
        picture = np.full((HEIGHT, WIDTH, 3), 200.0)
        for (cx, cy), colour in zip((STILL, moving), colours, strict=True):
            bgr = np.array([int(colour[k : k + 2], 16) for k in (5, 3, 1)])
            share = 1 / (1 + np.exp((np.hypot(x - cx, y - cy) - 9.0) / 0.6))[..., None]
            picture = picture * (1 - share) + bgr * share
        writer.write(np.round(picture).astype(np.uint8))
    writer.release()


def describe(folder, dots, unit="pixel", more=""):
    (folder / "campaign.yaml").write_text(
        "version: 1\nname: dots\nsource: measured\nspecimen:\n"
        f"  motion: {{quantity: distance, unit: {unit}}}\n  load: {{quantity: force, unit: N}}\n"
        f"camera:\n  fps: 10.0\n{more}  dots:\n{dots}"
    )
    (folder / "trials.csv").write_text("trial,video\none,film.avi\n")
    return read_campaign(folder)


CLICKED = "    a: {at_px: [42, 61], diameter_px: 18}\n    b: {at_px: [111, 59], diameter_px: 18}\n"
COLOURED = (
    '    a: {colour: "#c02020", diameter_px: 18}\n    b: {colour: "#2020c0", diameter_px: 18}\n'
)


@pytest.mark.parametrize(
    ("dots", "colours"),
    [(CLICKED, ("#000000", "#202020")), (COLOURED, ("#c02020", "#2020c0"))],
)
def test_dots_are_found_by_a_click_or_by_colour(tmp_path, dots, colours):
    film(tmp_path / "film.avi", colours)
    campaign = describe(tmp_path, dots)
    markers = track_video(tmp_path / "film.avi", campaign.camera)
    found = markers["marker_position"].to_numpy()
    np.testing.assert_allclose(found[:, 1], PATH, atol=0.1)
    np.testing.assert_allclose(found[:, 0] - STILL, 0.0, atol=0.1)
    assert markers["marker"].values.tolist() == ["a", "b"]
    artifact = markers.expand_dims(trial=["one"]).assign(set_aside_reason=("trial", [""]))
    angles = assemble_angles(campaign, [artifact])
    motion = angles["joint_angle"].values[0, 0] * angles.attrs["motion_per_rad"]
    expected = np.hypot(*(PATH - STILL).T)
    np.testing.assert_allclose(motion + angles.attrs["motion_zero"], expected, atol=0.1)
    assert np.isfinite(angles["joint_angle_covariance"]).all()


def test_the_unit_decides_what_of_the_line_is_the_motion(tmp_path):
    (tmp_path / "film.avi").write_bytes(b"x")
    place = np.stack([np.tile(STILL, (FRAMES, 1)), PATH], axis=1)
    markers = xr.Dataset(
        {"time": ("frame", 0.1 * np.arange(FRAMES)),
         "marker_position": (("frame", "marker", "axis"), place),
         "marker_position_sd": (("frame", "marker"), np.full((FRAMES, 2), 0.1)),
         "marker_flag": (("frame", "marker"), np.zeros((FRAMES, 2), np.uint8))},
        coords={"marker": ["a", "b"], "axis": ["x", "y"]},
    )  # fmt: skip
    campaign = describe(tmp_path, CLICKED, "deg")
    turned = measure_motion(markers, campaign)
    line = PATH - STILL
    expected = np.degrees(np.arctan2(-line[:, 1], line[:, 0]))
    np.testing.assert_allclose(turned["joint_angle"][0], expected)
    campaign = describe(tmp_path, CLICKED, "mm", "  metres_per_pixel: 0.0002\n")
    moved = measure_motion(markers, campaign)
    np.testing.assert_allclose(moved["joint_angle"][0], 0.2 * np.hypot(*line.T))
    np.testing.assert_allclose(moved["joint_angle_covariance"], 2 * (0.2 * 0.1) ** 2)
    with pytest.raises(Fault, match=r"camera\.metres_per_pixel is missing"):
        measure_motion(markers, describe(tmp_path, CLICKED, "mm"))


@pytest.mark.parametrize(
    ("dots", "said"),
    [
        ("    a: {diameter_px: 18}\n", "give either at_px or colour"),
        (CLICKED + '    c: {colour: "#202020", diameter_px: 18}\n', "at_px of every dot, or"),
        (CLICKED + "  markers: {base: [0, 1]}\n", "give either markers (on links) or dots"),
        ("    a: {at_px: [1, 2], diametre_px: 18}\n", "did you mean 'diameter_px'"),
    ],
)
def test_a_wrong_description_of_dots(tmp_path, dots, said):
    with pytest.raises(CampaignFault) as caught:
        describe(tmp_path, dots)
    assert said in str(caught.value)
