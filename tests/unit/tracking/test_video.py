import numpy as np
import pytest

from softfinger.tracking.video import peek_pictures


@pytest.fixture
def pictures(rng):
    return [rng.integers(0, 255, (48, 66, 1), dtype=np.uint8) for _ in range(20)]


def test_frames_come_in_order_with_their_times(rig, pictures, read):
    frames = read(rig.film(pictures, fps=25.0), 25.0)
    assert [frame.index for frame in frames] == list(range(20))
    np.testing.assert_allclose([frame.time for frame in frames], np.arange(20) / 25.0, atol=1e-6)
    for frame, picture in zip(frames, pictures, strict=True):
        np.testing.assert_array_equal(frame.picture[:, :, -1], picture[:, :, 0])


def test_a_missing_file_is_said(tmp_path, refuse):
    assert "does not exist" in refuse(tmp_path / "none.avi")


def test_an_empty_file_is_said(tmp_path, refuse):
    path = tmp_path / "empty.avi"
    path.touch()
    assert "0 bytes" in refuse(path)


@pytest.mark.parametrize("content", [b"\x00\x01garbage" * 500, b"time_s,q1_rad\n0,0\n"])
def test_what_is_no_video_is_said(tmp_path, content, refuse):
    path = tmp_path / "odd.avi"
    path.write_bytes(content)
    assert "cannot be decoded" in refuse(path)


@pytest.mark.parametrize(("name", "codec"), [("a.avi", "MJPG"), ("a.mkv", "FFV1")])
def test_a_truncated_file_is_said(rig, pictures, name, codec, refuse):
    path = rig.film(pictures, name, codec=codec)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    said = refuse(path)
    assert "cut off" in said
    assert "20" in said


def test_a_truncated_mp4_is_said(rig, pictures, refuse):
    path = rig.film(pictures, "a.mp4", codec="mp4v")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert "cannot be decoded" in refuse(path)


def test_a_wrong_frame_rate_is_said_and_one_per_cent_is_allowed(rig, pictures, read, refuse):
    path = rig.film(pictures, fps=30.0)
    said = refuse(path, 60.0)
    assert "30" in said
    assert "60" in said
    assert len(read(path, 30.2)) == 20
    assert "may differ" in refuse(path, 30.4)


def test_peeked_pictures_are_those_of_the_file(rig, pictures):
    path = rig.film(pictures)
    first, last = peek_pictures(path, (0.0, 1.0))
    np.testing.assert_array_equal(first[:, :, 0], pictures[0][:, :, 0])
    np.testing.assert_array_equal(last[:, :, 0], pictures[-1][:, :, 0])
