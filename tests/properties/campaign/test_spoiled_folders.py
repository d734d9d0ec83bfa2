"""Whatever a campaign folder holds: sentences, or angles to be believed; never a traceback."""

import shutil
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs.angles import SPEC
from softfinger.campaign import check_campaign, read_campaign
from softfinger.faults import Fault
from softfinger.tracking import assemble_angles

sys.path.insert(0, str(Path(__file__).parent))
from mutations import MUTATIONS, spoil

EXAMPLE = Path(__file__).parents[3] / "data/example"
MARKERS = """\
version: 1
name: markers, two joints
source: synthetic
finger: {joints: 2, link_length_m: [0.025, 0.025], wire_offset_m: 0.005}
camera:
  fps: 30.0
  metres_per_pixel: 0.0002
  marker_diameter_m: 0.004
  marker_colour: dark
  markers: {base: [-0.02, -0.01], link_1: [0.006, 0.019], link_2: [0.006, 0.019]}
"""


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory) -> list[Path]:
    """The example, of angles, and one of two trials in marker tables."""
    folder = tmp_path_factory.mktemp("markers") / "campaign"
    (folder / "markers").mkdir(parents=True)
    (folder / "campaign.yaml").write_text(MARKERS)
    (folder / "trials.csv").write_text(
        "trial,markers,load,temperature_c\na,markers/a.csv,load.csv,20\nb,markers/b.csv,load.csv,21\n"
    )
    (folder / "load.csv").write_text("time_s,tension_n\n0.0,6.0\n2.0,6.0\n")
    for name, stiffness in (("a", 0.1), ("b", 0.12)):
        (folder / f"markers/{name}.csv").write_text(write_markers(stiffness))
    return [EXAMPLE, folder]


def write_markers(stiffness):
    rows = ["time_s,marker,x_px,y_px"]
    places = ((-100, -50), (30, 95), (30, 95))
    for time in np.arange(0.0, 2.0, 1 / 30):
        bent = 0.03 / stiffness * (1 - np.exp(-3 * time))
        start = np.array([300.0, 400.0])
        for link, (own, turn) in enumerate(zip(places, (0.0, bent, 2 * bent), strict=True)):
            along = np.array([np.cos(turn), -np.sin(turn)])
            for k, place in enumerate(own):
                x, y = start + along * place
                name = f"link_{link}_{k + 1}" if link else f"base_{k + 1}"
                rows.append(f"{time:.4f},{name},{x:.3f},{y:.3f}")
            start = start + (along * 125 if link else 0)
    return "\n".join(rows) + "\n"


def judge(folder: Path) -> str:
    """Read a campaign as the workflow does; 'refused', 'some set aside' or 'used'."""
    try:
        reasons = check_campaign(folder)
        angles = assemble_angles(read_campaign(folder), [])
    except Fault as fault:
        said = str(fault)
    else:
        assert all(str(reason).strip() for reason in reasons.values())
        believe(angles)
        return "some set aside" if angles.sizes["set_aside_trial"] else "used"
    assert said.strip()
    assert "Traceback" not in said
    return "refused"


def believe(angles: xr.Dataset) -> None:
    """What comes out is a valid artifact, in believable ranges, each value flagged or finite."""
    assert list_faults(SPEC, angles) == []
    time = angles["time"].to_numpy()
    assert (np.diff(time, axis=1)[np.isfinite(np.diff(time, axis=1))] > 0).all()
    angle = angles["joint_angle"].to_numpy()
    inside = np.isfinite(time)[:, None, :]
    missing = (angles["angle_flag"].to_numpy() & 1) > 0
    assert np.isfinite(angle[inside & ~missing]).all()
    assert np.nanmax(np.abs(angle)) <= 2 * np.pi
    assert np.isfinite(angles["load_torque"].to_numpy()).all()


def spoil_many(campaigns, tmp_path, seeds):
    verdicts = {}
    for seed in seeds:
        rng = np.random.default_rng(seed)
        folder = tmp_path / str(seed)
        done = spoil(campaigns[seed % 2], folder, rng)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                verdicts[seed] = judge(folder)
        except Exception as error:
            error.add_note(f"seed {seed}: {', '.join(done)}")
            raise
    return verdicts


def test_spoiled_campaigns_give_sentences(campaigns, tmp_path):
    verdicts = spoil_many(campaigns, tmp_path, range(60))
    assert set(verdicts.values()) == {"refused", "some set aside", "used"}


@pytest.mark.slow
def test_ten_thousand_spoiled_campaigns_give_sentences(campaigns, tmp_path):
    for first in range(1000, 11000, 500):
        folder = tmp_path / str(first)
        spoil_many(campaigns, folder, range(first, first + 500))


def test_whole_campaigns_are_used(campaigns):
    assert [judge(folder) for folder in campaigns] == ["used", "used"]


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.__name__)
def test_each_kind_of_damage_alone(mutation, campaigns, tmp_path):
    for number, source in enumerate(campaigns):
        folder = tmp_path / str(number)
        shutil.copytree(source, folder)
        mutation(folder, np.random.default_rng(number))
        judge(folder)
