"""Videos that are made to harm: each is read as it is meant, or refused in one sentence."""

import os
import struct
from pathlib import Path

import cv2
import numpy as np
import pytest

from softfinger.tracking.video import read_frames

HUGE = 100_000


def pack_chunk(name: bytes, content: bytes) -> bytes:
    return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)


def pack_list(name: bytes, *chunks: bytes) -> bytes:
    return pack_chunk(b"LIST", name + b"".join(chunks))


def write_avi(path: Path, pictures, size=None, frames=None, fps=30) -> Path:
    """Write Motion JPEG in an AVI whose header claims any size (width, height) and count."""
    width, height = size or pictures[0].shape[1::-1]
    count = len(pictures) if frames is None else frames
    main = struct.pack("<10I16x", 1_000_000 // fps, 0, 0, 0x10, count, 0, 1, 0, width, height)
    stream = b"vidsMJPG" + struct.pack("<10I8x", 0, 0, 0, 1, fps, 0, count, 0, 0xFFFFFFFF, 0)
    form = struct.pack("<IiiHH4s5I", 40, width, height, 1, 24, b"MJPG", 0, 0, 0, 0, 0)
    coded = [cv2.imencode(".jpg", picture)[1].tobytes() for picture in pictures]
    headers = pack_list(b"strl", pack_chunk(b"strh", stream), pack_chunk(b"strf", form))
    content = b"AVI " + pack_list(b"hdrl", pack_chunk(b"avih", main), headers)
    content += pack_list(b"movi", *[pack_chunk(b"00dc", one) for one in coded])
    path.write_bytes(pack_chunk(b"RIFF", content))
    return path


def edit_box(path: Path, name: bytes, edit) -> None:
    """Change the content of an MP4's box at the end of its file; all around it grow."""
    content = path.read_bytes()
    at = content.rindex(name) - 4
    (old,) = struct.unpack(">I", content[at : at + 4])
    new = edit(content[at + 8 : at + old])
    grown = bytearray(content[:at] + struct.pack(">I", len(new) + 8) + name + new)
    for parent in (b"moov", b"trak", b"mdia", b"minf", b"stbl") if len(new) + 8 != old else ():
        place = grown.rindex(parent) - 4
        (length,) = struct.unpack(">I", grown[place : place + 4])
        grown[place : place + 4] = struct.pack(">I", length + len(new) + 8 - old)
    path.write_bytes(bytes(grown) + content[at + old :])


@pytest.fixture
def pictures(rng):
    return [rng.integers(0, 255, (48, 66, 3), dtype=np.uint8) for _ in range(12)]


def test_the_writer_of_these_tests_writes_videos(tmp_path, pictures, read):
    assert [f.picture.shape for f in read(write_avi(tmp_path / "a.avi", pictures))] == [
        (48, 66, 3)
    ] * 12


def test_a_size_that_changes_is_refused(tmp_path, pictures, refuse):
    other = [np.ascontiguousarray(p[:32, :40]) for p in pictures[6:]]
    said = refuse(write_avi(tmp_path / "a.avi", [*pictures[:6], *other]))
    assert "one size" in said


def test_a_picture_of_one_pixel_is_refused(tmp_path, refuse):
    assert "1 × 1 px" in refuse(write_avi(tmp_path / "a.avi", [np.zeros((1, 1, 3), np.uint8)] * 9))


def test_8k_is_read(tmp_path, read):
    frames = read(write_avi(tmp_path / "a.avi", [np.zeros((4320, 7680, 3), np.uint8)] * 2))
    assert [frame.picture.shape for frame in frames] == [(4320, 7680, 3)] * 2


def test_a_container_that_claims_another_size_than_its_pictures_changes_nothing(
    tmp_path, pictures, read
):
    frames = read(write_avi(tmp_path / "a.avi", pictures, size=(HUGE, HUGE)))
    assert {frame.picture.shape for frame in frames} == {(48, 66, 3)}


@pytest.mark.parametrize("size", [(HUGE, HUGE), (40_000, 40_000), (65_535, 65_535)])
def test_pictures_that_claim_thousands_of_millions_of_pixels_are_refused(
    tmp_path, pictures, size, refuse
):
    path = write_avi(tmp_path / "a.avi", pictures, size=size)
    claim = struct.pack(">2H", *[min(length, 65_535) for length in size])
    honest = struct.pack(">2H", 48, 66)
    path.write_bytes(path.read_bytes().replace(honest, claim))
    refuse(path)
    raw = tmp_path / "b.avi"
    raw.write_bytes(path.read_bytes().replace(b"MJPG", b"I420"))
    refuse(raw)


def test_a_header_that_claims_a_thousand_million_frames_is_no_reason_to_wait(
    tmp_path, pictures, read
):
    assert len(read(write_avi(tmp_path / "a.avi", pictures, frames=10**9))) == 12


def test_a_rotated_video_is_upright_throughout(rig, pictures, read):
    path = rig.film(pictures, "a.mp4", codec="mp4v")
    quarter = struct.pack(">9i", 0, 1 << 16, 0, -(1 << 16), 0, 0, 48 << 16, 0, 1 << 30)
    edit_box(path, b"tkhd", lambda box: box[:40] + quarter + box[76:])
    assert {frame.picture.shape for frame in read(path)} == {(66, 48, 3)}


def test_a_variable_rate_keeps_its_own_times(rig, pictures, read):
    path = rig.film(pictures, "a.mp4", codec="mp4v")
    unit = struct.unpack(">I", path.read_bytes().split(b"stts")[-1][12:16])[0]
    uneven = struct.pack(">IIIIIIII", 0, 3, 4, unit, 4, unit // 2, 4, unit + unit // 2)
    edit_box(path, b"stts", lambda box: uneven)
    steps = np.diff([frame.time for frame in read(path)]) * 30.0
    np.testing.assert_allclose(steps, [1] * 4 + [0.5] * 4 + [1.5] * 3, atol=0.05)


@pytest.mark.parametrize("content", ["time_s,q1_rad\n0,0\n", "ffconcat version 1.0\nfile a.avi\n"])
def test_text_that_is_named_as_a_video_is_refused(tmp_path, pictures, content, refuse):
    write_avi(tmp_path / "a.avi", pictures)
    path = tmp_path / "b.mp4"
    path.write_text(content)
    assert "cannot be decoded" in refuse(path)


def test_a_clock_that_goes_back_is_refused(tmp_path, pictures, monkeypatch, refuse):
    def decode(*_):
        yield {"frames": 4, "rate": 30.0}, np.empty(0)
        for stamp in (0.0, 0.033, 9.0, 0.1):
            yield {"stamp": stamp, "shape": (1, 1, 1)}, np.zeros(1, np.uint8)

    monkeypatch.setattr("softfinger.tracking.video.read_in_child", decode)
    assert "goes back from 9.000 s" in refuse(write_avi(tmp_path / "a.avi", pictures))


def list_children():
    """Numbers of the processes that this one has started, other tests' among them."""
    return set(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split())


def test_no_decoder_is_left(tmp_path, pictures):
    before = list_children()
    frames = read_frames(write_avi(tmp_path / "a.avi", pictures), 30.0)
    next(frames)
    frames.close()
    assert list_children() <= before
