"""A small whole campaign, written plainly, that each test damages in one place."""

from pathlib import Path

import pytest

DESCRIPTION = """\
version: 1
name: two joints by hand
source: measured
finger:
  joints: 2
  link_length_m: [0.025, 0.03]
  wire_offset_m: 0.005
camera:
  fps: 30.0
  metres_per_pixel: 0.0002
  markers:
    base: [-0.018, -0.006]
    link_1: [0.006, 0.019]
    link_2: [0.006, 0.019]
  marker_diameter_m: 0.004
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "campaign.yaml").write_text(DESCRIPTION)
    (tmp_path / "trials.csv").write_text(
        "trial,started_at,angles,markers,load,temperature_c\n"
        "first,2026-03-01T10:00:00,angles/first.csv,,load/first.csv,21.5\n"
        "second,2026-03-01T10:02:00,,markers/second.csv,load/first.csv,\n"
        "third,,angles/first.csv,,load/first.csv,22.0\n"
    )
    for name in ("angles", "markers", "load"):
        (tmp_path / name).mkdir()
    (tmp_path / "angles/first.csv").write_text(
        "time_s,q1_rad,q2_rad\n0.0,0.01,0.02\n0.1,0.11,nan\n0.2,,0.22\n0.3,0.31,0.32\n"
    )
    (tmp_path / "load/first.csv").write_text("time_s,tension_n\n0.0,0\n0.1,8\n2.0,8\n2.5,4\n")
    rows = [
        f"{t},{m},{10 * k + t},{5 * k},0.1"
        for t in (0.0, 0.5, 1.0)
        for k, m in enumerate(["link_1_2", "base_1", "base_2", "link_1_1", "link_2_1", "link_2_2"])
    ]
    (tmp_path / "markers/second.csv").write_text(
        "time_s,marker,x_px,y_px,sd_px\n" + "\n".join(rows) + "\n"
    )
    return tmp_path


def replace(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.fixture
def damage(folder: Path):
    """Replace a piece of text in one file of the campaign."""
    return lambda file, old, new: replace(folder / file, old, new)
