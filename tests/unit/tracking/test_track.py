from types import SimpleNamespace

import numpy as np
import pytest
from benchmarks._discs import expose

from softfinger.artifacts import list_faults
from softfinger.artifacts.specs.markers import SPEC
from softfinger.campaign import marker_names
from softfinger.faults import TrialFault
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking import track_trials, track_video

FRAMES = 24


@pytest.fixture
def truth(rig):
    bend = 1.0 - np.exp(-np.arange(FRAMES) / 6.0)
    return np.array([rig.place((0.5 * b, 0.9 * b)) for b in bend])


@pytest.fixture
def pictures(rig, truth):
    return [rig.draw(places, shade=0.4) for places in truth]


def track(rig, path, **changes):
    return track_video(path, rig.camera.model_copy(update=changes), rig.link_length)


@pytest.mark.parametrize("colour", ["dark", None])
def test_a_film_becomes_the_places_of_its_markers(rig, truth, pictures, colour):
    found = track(rig, rig.film(pictures), marker_colour=colour)
    assert found["marker"].to_numpy().tolist() == marker_names(rig.camera)
    np.testing.assert_allclose(found["time"], np.arange(FRAMES) / 30.0, atol=1e-6)
    assert (found["marker_flag"] == 0).all()
    off = (found["marker_position"].to_numpy() - truth) / found["marker_position_sd"].to_numpy()[
        ..., None
    ]
    assert 0.8 < np.sqrt(np.mean(off**2)) < 1.25


def test_coded_films_are_tracked_too(rig, truth, pictures):
    found = track(rig, rig.film(pictures, codec="MJPG"))
    assert np.abs(found["marker_position"].to_numpy() - truth).max() < 0.1


def test_light_markers_on_a_dark_finger(rig, truth):
    film = rig.film([rig.draw(places, level=40.0, contrast=140.0) for places in truth])
    found = track(rig, film, marker_colour="light")
    assert np.abs(found["marker_position"].to_numpy() - truth).max() < 0.06
    with pytest.raises(TrialFault, match="shows the 7 declared markers"):
        track(rig, film, marker_colour="dark")


def test_coloured_markers_are_told_from_others(rig, truth):
    other = [(30.0, 30.0), (190.0, 30.0), (40.0, 135.0)]
    pictures = []
    for places in truth:
        red, dark = (rig.draw(p, noise=0.0)[:, :, 0].astype(float) for p in (places, other))
        paint = [1.0 - (180.0 - red) / 120.0 * share for share in (0.8, 0.7, 0.05)]
        light = np.stack([p * dark for p in paint], axis=2)
        pictures.append(expose(light, 1.5, rig.rng))
    found = track(rig, rig.film(pictures, codec="MJPG"), marker_colour="#ac4030")
    assert np.abs(found["marker_position"].to_numpy() - truth).max() < 0.15
    assert (found["marker_flag"] == 0).all()


def test_blobs_that_are_no_markers_are_ignored(rig, truth):
    decoys = [(20.0, 20.0), (60.0, 40.0), (150.0, 130.0), (200.0, 25.0)]
    film = rig.film([rig.draw([*places, *decoys]) for places in truth])
    found = track(rig, film)
    assert np.abs(found["marker_position"].to_numpy() - truth).max() < 0.06


def test_markers_that_are_nowhere_are_said(rig):
    path = rig.film([rig.draw([(50.0, 60.0)]) for _ in range(35)])
    with pytest.raises(TrialFault) as caught:
        track(rig, path)
    for said in ("trial.avi", "7 declared markers", "35 frames", "220 × 150", "at most 1 discs"):
        assert said in str(caught.value)


def test_frames_before_the_finger_comes_into_view_are_missing(rig, truth, pictures):
    found = track(rig, rig.film([rig.draw(truth[0][:4]) for _ in range(5)] + pictures))
    assert (found["marker_flag"][:5] == MISSING).all()
    assert np.isnan(found["marker_position"][:5]).all()
    assert np.isnan(found["marker_position_sd"][:5]).all()
    assert np.abs(found["marker_position"].to_numpy()[5:] - truth).max() < 0.06


def test_repeated_frames_are_stale(rig, pictures):
    repeated = [picture for k, picture in enumerate(pictures) for _ in range(1 + (k in (6, 15)))]
    flag = track(rig, rig.film(repeated))["marker_flag"].to_numpy()
    assert (flag[[7, 17]] == STALE).all()
    assert (np.delete(flag, [7, 17], axis=0) == 0).all()


def test_a_hidden_marker_is_missing_not_invented(rig, truth):
    hidden = range(8, 14)
    film = rig.film(
        [rig.draw(np.delete(p, 6, axis=0) if k in hidden else p) for k, p in enumerate(truth)]
    )
    found = track(rig, film)
    expected = np.zeros((FRAMES, 7), np.uint8)
    expected[list(hidden), 6] = MISSING
    np.testing.assert_array_equal(found["marker_flag"], expected)


def test_a_glare_on_a_marker_is_suspect_or_missing_and_so_is_no_other(rig, truth, pictures):
    for k in (9, 10):
        x, y = np.round(truth[k, 4]).astype(int)
        pictures[k][y - 4 : y + 1, x : x + 5] = 250
    found = track(rig, rig.film(pictures))
    flag = found["marker_flag"].to_numpy()
    assert (flag[[9, 10], 4] & (JUMP | MISSING)).all()
    assert (np.delete(flag, 4, axis=1) == 0).all()


def test_an_unknown_scale_is_found_from_the_markers_size(rig, truth, pictures):
    intrinsics = {"matrix": [[300, 0, 110], [0, 300, 75], [0, 0, 1]], "distortion": []}
    camera = rig.camera.model_dump() | {"metres_per_pixel": None, "intrinsics": intrinsics}
    found = track_video(rig.film(pictures), type(rig.camera)(**camera), rig.link_length)
    assert np.abs(found["marker_position"].to_numpy() - truth).max() < 0.06


def test_the_end_that_stands_still_is_the_base(rig):
    # A finger that looks the same from either end: only its motion tells base from tip.
    places = {"base": (-0.022, -0.007), "link_1": (0.007, 0.022)}
    camera = rig.camera.model_copy(update={"markers": places})
    turns = 0.5 * (1.0 - np.exp(-np.arange(FRAMES) / 6.0))
    joint = np.array([110.0, 80.0])
    along = np.stack([np.cos(turns), -np.sin(turns)], axis=1)[:, None]
    still = joint + np.array([-44.0, -14.0])[:, None] * [1.0, 0.0]
    truth = np.concatenate(
        [np.broadcast_to(still, (FRAMES, 2, 2)), joint + np.array([14.0, 44.0])[:, None] * along], 1
    )
    for mirrored in (False, True):
        film = [rig.draw((219.0, 0.0) - p * (1, -1) if mirrored else p) for p in truth]
        found = track_video(rig.film(film), camera, (0.022,))["marker_position"].to_numpy()
        expected = (219.0, 0.0) - truth * (1, -1) if mirrored else truth
        assert np.abs(found - expected).max() < 0.06


def test_a_batch_keeps_good_trials_and_says_why_others_are_not_used(rig, pictures):
    rig.film(pictures, "good.avi")
    rig.film(pictures[:15], "short.avi")
    broken = rig.film(pictures, "broken.avi")
    broken.write_bytes(broken.read_bytes()[:5000])
    names = ["short", "broken", "good"]
    campaign = SimpleNamespace(
        camera=rig.camera,
        finger=SimpleNamespace(link_length_m=rig.link_length),
        trials=[SimpleNamespace(name=n, recording=rig.folder / f"{n}.avi") for n in names],
    )
    found = track_trials(campaign, names)
    assert list_faults(SPEC, found) == []
    reasons = found["set_aside_reason"].to_numpy()
    assert reasons[0] == reasons[2] == ""
    assert reasons[1].startswith("broken.avi: ")
    assert found["marker_position"].dims == ("trial", "frame", "marker", "axis")
    np.testing.assert_array_equal(np.isfinite(found["time"]).sum("frame"), [15, 0, FRAMES])
    assert (found["marker_flag"].sel(trial="short")[15:] == MISSING).all()
    alone = track(rig, rig.folder / "good.avi")["marker_position"]
    np.testing.assert_array_equal(found["marker_position"].sel(trial="good"), alone)
