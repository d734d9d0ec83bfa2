"""A damaged or foreign NetCDF file is refused in a sentence; no number of it is believed."""

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts import open_artifact, open_tree, save_artifact, save_tree
from softfinger.artifacts.checksum import append_checksum
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.campaign import read_campaign
from softfinger.faults import ArtifactFault
from softfinger.provenance import Provenance
from softfinger.tracking import assemble_angles

sys.path.insert(0, str(Path(__file__).parents[1]))
from damage import DAMAGES, spoil_file

EXAMPLE = Path(__file__).parents[3] / "data/example"
ORIGIN = Provenance("angles", {"tables": "ab"}, "cd", "ef", "01", 3)


@pytest.fixture(scope="module")
def angles(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("angles") / "angles.nc"
    found = assemble_angles(read_campaign(EXAMPLE), [])
    save_artifact(found.isel(frame=slice(60)), angles_spec.SPEC, path, ORIGIN)
    return path


@pytest.fixture(scope="module")
def posterior(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("posterior") / "posterior.nc"
    rng = np.random.default_rng(4)
    sizes = {"chain": 2, "draw": 30, "trial": 5, "joint": 3, "own": 12, "other_own": 12}
    groups = {}
    for name in ("posterior", "sample_stats"):
        declared = posterior_spec.SPEC.groups[name]
        groups[name] = xr.Dataset(
            {
                key: (v.dims, rng.uniform(0.1, 0.9, [sizes[d] for d in v.dims]) > 0.5)
                if v.kind == "truth value"
                else (v.dims, rng.uniform(0.1, 0.9, [sizes[d] for d in v.dims]))
                for key, v in declared.items()
            }
        )
    tree = xr.DataTree.from_dict(groups)
    tree.attrs["note"] = ""
    save_tree(tree, posterior_spec.SPEC, path, ORIGIN)
    return path


def refuse(source, folder, load, seeds) -> None:
    """Spoil a file once per seed; every copy is refused in one sentence."""
    path = folder / source.name
    for seed in seeds:
        done = spoil_file(source, path, np.random.default_rng(seed))
        if path.read_bytes() == source.read_bytes():  # zeros where there were zeros
            continue
        said = open_spoiled(load, path)
        assert "does not end in the checksum" in said, f"seed {seed}: {done}"


def open_spoiled(load, path) -> str:
    try:
        load(path)
    except ArtifactFault as fault:
        return str(fault)
    return "opened"


def load_angles(path):
    return open_artifact(path, angles_spec.SPEC)


def load_posterior(path):
    return open_tree(path, posterior_spec.SPEC)


def test_whole_artifacts_are_opened(angles, posterior):
    assert load_angles(angles).sizes["frame"] == 60
    assert load_posterior(posterior)["posterior"].sizes["draw"] == 30


def test_spoiled_artifacts_are_refused(angles, posterior, tmp_path):
    refuse(angles, tmp_path, load_angles, range(300))
    refuse(posterior, tmp_path, load_posterior, range(300, 600))


@pytest.mark.slow
def test_ten_thousand_spoiled_artifacts_are_refused(angles, posterior, tmp_path):
    refuse(angles, tmp_path, load_angles, range(1000, 6000))
    refuse(posterior, tmp_path, load_posterior, range(6000, 11000))


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_damage_changes_bytes(damage):
    data = np.random.default_rng(0).bytes(20_000)
    assert damage(data, np.random.default_rng(1)) != data


def turn_to_degrees(angles):
    return angles.assign(joint_angle=np.rad2deg(angles["joint_angle"]))


def swap_dims(angles):
    return angles.transpose("frame", "joint", ...)


def rename_variable(angles):
    return angles.rename(load_torque="torque")


def turn_to_words(angles):
    return angles.assign(time=angles["time"].astype(str))


def turn_to_whole_numbers(angles):
    return angles.assign(load_time=angles["load_time"].astype(int))


def drop_trial_names(angles):
    return angles.drop_vars("trial")


def add_unknown(angles):
    return angles.assign(surprise=angles["time"] * 2)


def drop_source(angles):
    changed = angles.copy()
    del changed.attrs["source"]
    return changed


def declare_degrees(angles):
    changed = angles.copy(deep=True)
    changed["joint_angle"].attrs["units"] = "deg"
    return changed


def declare_no_unit(angles):
    changed = angles.copy(deep=True)
    del changed["wire_offset"].attrs["units"]
    return changed


EDITS = {
    turn_to_degrees: "expected -12.5664 to 12.5664",
    swap_dims: "has dims ('frame', 'joint', 'trial')",
    rename_variable: "variable 'torque' is not declared",
    turn_to_words: "expected numbers",
    turn_to_whole_numbers: "has the type int64; expected numbers",
    drop_trial_names: "coordinate 'trial' ('trial',) [1] is missing",
    add_unknown: "variable 'surprise' is not declared",
    drop_source: "attribute 'source' is missing",
    declare_degrees: "variable 'joint_angle' is in deg; expected rad",
    declare_no_unit: "variable 'wire_offset' is in None; expected m",
}


@pytest.mark.parametrize(("edit", "said"), EDITS.items(), ids=lambda e: getattr(e, "__name__", ""))
def test_what_the_declaration_forbids_is_refused(edit, said, angles, tmp_path):
    path = tmp_path / "edited.nc"
    whole = xr.load_dataset(angles, engine="h5netcdf")
    edit(whole).to_netcdf(path, engine="h5netcdf")
    append_checksum(path)
    with pytest.raises(ArtifactFault) as caught:
        open_artifact(path, angles_spec.SPEC)
    assert said in str(caught.value)


def test_the_same_file_written_by_another_program_is_refused(angles, tmp_path):
    path = tmp_path / "copied.nc"
    xr.load_dataset(angles, engine="h5netcdf").to_netcdf(path, engine="h5netcdf")
    with pytest.raises(ArtifactFault, match="does not end in the checksum"):
        open_artifact(path, angles_spec.SPEC)
    append_checksum(path)
    open_artifact(path, angles_spec.SPEC)
