"""What a campaign declares arrives at the model."""

import numpy as np
import pytest

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.campaign import read_campaign
from softfinger.config import read_config
from softfinger.stages.prepare import prepare_angles
from softfinger.tracking import assemble_angles

CAMERA = """\
camera:
  fps: 30
  metres_per_pixel: 0.0005
  markers: {base: [-0.02, -0.01], link_1: [0.01, 0.02]}
  marker_diameter_m: 0.004
  marker_colour: dark
"""
DESCRIPTION = """\
version: 1
name: one joint
source: measured
finger: {joints: 1, link_length_m: [0.03], link_mass_kg: [0.005], wire_offset_m: 0.005}
noise_sd_rad: 0.003
"""


def write_campaign(folder, description):
    folder.mkdir()
    time = np.arange(60) / 30.0
    rng = np.random.default_rng(4)
    for trial in ("a", "b"):
        angle = 0.4 * (1.0 - np.exp(-time / 0.4)) + 0.003 * rng.standard_normal(time.size)
        rows = "\n".join(f"{t:.6f},{q:.6f}" for t, q in zip(time, angle, strict=True))
        (folder / f"{trial}.csv").write_text(f"time_s,q1_rad\n{rows}\n")
    (folder / "load.csv").write_text("time_s,tension_n\n0,5\n2,5\n")
    (folder / "trials.csv").write_text("trial,angles,load\na,a.csv,load.csv\nb,b.csv,load.csv\n")
    (folder / "campaign.yaml").write_text(description)
    return folder


@pytest.mark.parametrize(("camera", "declared"), [(CAMERA, 1), ("", 0)])
def test_a_declared_camera_is_in_the_artifact(tmp_path, camera, declared):
    folder = write_campaign(tmp_path / "campaign", DESCRIPTION + camera)
    path = prepare_angles(folder, tmp_path, read_config())
    assert open_artifact(path, angles_spec.SPEC).attrs["camera"] == declared


def test_no_attribute_of_the_angles_is_lost_in_their_artifact(tmp_path):
    folder = write_campaign(tmp_path / "campaign", DESCRIPTION + CAMERA)
    made = assemble_angles(read_campaign(folder), [], read_config()["tracking"])
    saved = open_artifact(prepare_angles(folder, tmp_path, read_config()), angles_spec.SPEC)
    assert {key: saved.attrs[key] for key in made.attrs} == made.attrs
