import numpy as np
import xarray as xr

from softfinger.measurement.flags import JUMP, MISSING
from softfinger.tracking.plausibility import flag_markers

NAMES = ["base_1", "base_2", "link_1_1", "link_1_2", "link_1_3"]


def build(rng, frames=90):
    time = np.arange(frames) / 30.0
    turn = 0.4 * (1.0 - np.exp(-time))
    along = np.stack([np.cos(turn), -np.sin(turn)], axis=-1)[:, None]
    link = np.array([60.0, 90.0]) + np.array([14.0, 26.0, 38.0])[None, :, None] * along
    base = np.broadcast_to([[20.0, 90.0], [45.0, 90.0]], (frames, 2, 2))
    position = np.concatenate([base, link], axis=1)
    return xr.Dataset(
        {
            "time": ("frame", time),
            "marker_position": (
                ("frame", "marker", "axis"),
                position + 0.02 * rng.standard_normal(position.shape),
            ),
        },
        coords={"marker": NAMES, "axis": ["x", "y"]},
    )


def test_clean_markers_are_not_suspect(rng):
    assert (flag_markers(build(rng), np.array([0.0]))["marker_flag"] == 0).all()


def test_swapped_names_are_found_on_both_markers(rng):
    markers = build(rng)
    both = markers["marker_position"].to_numpy()
    both[40:43, [0, 2]] = both[40:43, [2, 0]]
    flag = flag_markers(markers, np.array([0.0]))["marker_flag"].to_numpy()
    # The rest of either link is then at a wrong distance as well.
    np.testing.assert_array_equal(np.flatnonzero((flag & JUMP).any(axis=1)), [40, 41, 42])
    assert (flag[40:43] == JUMP).all()


def test_a_false_blob_for_good_is_found_by_the_links_rigidity(rng):
    markers = build(rng)
    markers["marker_position"][60:, 4] = [150.0, 20.0]
    flag = flag_markers(markers, np.array([0.0]))["marker_flag"].to_numpy()
    assert (flag[60:, 2:] == JUMP).all()
    assert (flag[:60] == 0).all()
    assert (flag[:, :2] == 0).all()


def test_missing_markers_are_flagged_and_earlier_flags_kept(rng):
    markers = build(rng)
    markers["marker_position"][7, 1] = np.nan
    before = np.zeros((90, 5), np.uint8)
    before[9, 3] = 2
    flagged = flag_markers(markers.assign(marker_flag=(("frame", "marker"), before)), np.array([]))
    flag = flagged["marker_flag"].to_numpy()
    assert (flag[7, 1], flag[9, 3], (flag > 0).sum()) == (MISSING, 2, 2)
