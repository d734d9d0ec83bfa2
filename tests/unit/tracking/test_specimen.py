import numpy as np
import pytest

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.angles import SPEC
from softfinger.campaign import list_tables, read_campaign
from softfinger.config import read_config
from softfinger.estimation.least_squares import fit_least_squares
from softfinger.faults import CampaignFault
from softfinger.stages.angles import angles
from softfinger.tracking import assemble_angles

TIME = np.linspace(0.0, 20.0, 201)


def creep(load: float, k: float, c: float, flow: float) -> np.ndarray:
    """Motion of the three-element model under a step of load at 1 s."""
    since = np.maximum(TIME - 1.0, 0.0)
    return load * ((1.0 - np.exp(-since * k / c)) / k + since / flow)


def write(folder, motion_unit, load_unit, motion_factor, load_factor, zero=0.0):
    folder.mkdir()
    noise = 0.004 * motion_factor
    (folder / "campaign.yaml").write_text(
        "version: 1\nname: beam\nsource: measured\nspecimen:\n"
        f"  motion: {{quantity: displacement, unit: {motion_unit}, noise_sd: {noise}}}\n"
        f"  load: {{quantity: force, unit: {load_unit}}}\n"
    )
    rng = np.random.default_rng(3)
    rows = ["trial,angles,load"]
    for i in range(5):
        motion = creep(3.0, 2.0 + 0.1 * i, 1.5, 60.0) + 0.004 * rng.normal(size=TIME.size)
        table = np.column_stack([TIME, (motion + zero) * motion_factor])
        np.savetxt(folder / f"m{i}.csv", table, "%.17g", ",", header="time_s,motion", comments="")
        load = f"time_s,load\n0,0\n1,0\n1,{3.0 * load_factor}\n20,{3.0 * load_factor}\n"
        (folder / f"l{i}.csv").write_text(load)
        rows.append(f"t{i},m{i}.csv,l{i}.csv")
    (folder / "trials.csv").write_text("\n".join(rows) + "\n")
    return assemble_angles(read_campaign(folder), [])


def fit(angles):
    return fit_least_squares(angles, read_config()["estimation"])


def test_a_change_of_unit_changes_nothing_but_the_unit(tmp_path):
    metres = write(tmp_path / "m", "m", "N", 1.0, 1.0)
    small = write(tmp_path / "um", "um", "kN", 1e6, 1e-3)
    np.testing.assert_allclose(small["joint_angle"], metres["joint_angle"], rtol=1e-9, atol=1e-12)
    assert small.attrs["motion_per_rad"] == pytest.approx(1e6 * metres.attrs["motion_per_rad"])
    assert small.attrs["noise_sd_rad"] == pytest.approx(metres.attrs["noise_sd_rad"])
    one, other = (fit(angles)["estimate"].isel(joint=0) for angles in (metres, small))
    np.testing.assert_allclose(other[:, 3], one[:, 3], atol=1e-7)
    np.testing.assert_allclose(other[:, :3], 1e-3 * one[:, :3], rtol=1e-6)
    # In the declared units: stiffness 2 to 2.4 N/m.
    stiffness = one.sel(parameter="k_v") / metres.attrs["motion_per_rad"]
    np.testing.assert_allclose(stiffness, 2.0 + 0.1 * np.arange(5), rtol=0.02)


def test_the_declared_units_are_kept_in_the_file(tmp_path):
    write(tmp_path / "a", "mm", "N", 1, 1)
    config = read_config()["tracking"]
    tables = list_tables(read_campaign(tmp_path / "a"))
    target = tmp_path / "angles.nc"
    angles(folder=tmp_path / "a", tables=tables, markers=[], angles=target, config=config)
    attrs = open_artifact(target, SPEC).attrs
    assert (attrs["motion_quantity"], attrs["motion_unit"]) == ("displacement", "mm")
    assert (attrs["load_quantity"], attrs["load_unit"]) == ("force", "N")
    assert attrs["motion_per_rad"] > 1.0


def test_a_motion_far_from_zero_is_measured_from_its_rest(tmp_path):
    near, far = write(tmp_path / "a", "mm", "N", 1, 1), write(tmp_path / "b", "mm", "N", 1, 1, 500)
    assert far.attrs["motion_zero"] == pytest.approx(500, abs=0.02)
    np.testing.assert_allclose(far["joint_angle"], near["joint_angle"], atol=1e-9)


def test_a_test_at_constant_strain_is_refused(tmp_path):
    write(tmp_path / "a", "mm", "N", 1, 1)
    held = np.where(TIME < 1, 0.0, 2.0) + 1e-3 * np.sin(40 * TIME)
    load = np.where(TIME < 1, 0.0, 5.0 * (0.4 + 0.6 * np.exp(-(TIME - 1) / 8)))
    header = {"header": "time_s,motion", "comments": "", "delimiter": ","}
    np.savetxt(tmp_path / "a/m2.csv", np.column_stack([TIME, held]), **header)
    header["header"] = "time_s,load"
    np.savetxt(tmp_path / "a/l2.csv", np.column_stack([TIME, load]), **header)
    gathered = assemble_angles(read_campaign(tmp_path / "a"), [])
    assert gathered["set_aside_trial"].values.tolist() == ["t2"]
    assert "at constant strain (relaxation)" in str(gathered["set_aside_reason"].values[0])
    (tmp_path / "a/trials.csv").write_text("trial,angles,load\nt2,m2.csv,l2.csv\n")
    with pytest.raises(CampaignFault, match="record a test at constant load"):
        assemble_angles(read_campaign(tmp_path / "a"), [])
