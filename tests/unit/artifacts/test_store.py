import dataclasses

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts import (
    ArtifactSpec,
    Variable,
    list_faults,
    open_artifact,
    open_tree,
    save_artifact,
    save_tree,
)
from softfinger.artifacts.specs import list_specs
from softfinger.faults import ArtifactFault
from softfinger.provenance import Provenance

SPEC = ArtifactSpec(
    name="toy",
    title="A toy",
    rule="play",
    attrs=("campaign",),
    coords={"trial": Variable(("trial",), "1", "name", "text")},
    variables={
        "angle": Variable(("trial", "frame"), "rad", "angle", at_least=-3.0, at_most=3.0),
        "kept": Variable(("trial",), "1", "whether it is kept", "truth value"),
        "extra": Variable((), "s", "a scalar that may be left out", optional=True),
    },
)
TREE = ArtifactSpec(
    name="tree",
    title="A tree",
    rule="play",
    variables={},
    groups={
        "posterior": {"mu": Variable(("chain", "draw"), "1", "mean of the log")},
        "independence": {"p": Variable((), "1", "p-value", at_most=1.0, optional=True)},
    },
)
ORIGIN = Provenance("play", {"angles": "ab"}, "cd", "ef", "01", 3)


def make_toy() -> xr.Dataset:
    angle = xr.DataArray(np.linspace(-1, 1, 6).reshape(2, 3), dims=("trial", "frame"))
    angle.attrs["units"] = "degrees"  # carried along by arithmetic: must not be believed
    return xr.Dataset(
        {"angle": angle, "kept": ("trial", [True, False])},
        coords={"trial": ["a", "b"]},
        attrs={"campaign": "x", "clock": "12:00"},
    )


def test_what_is_saved_comes_back_with_units_and_provenance(tmp_path):
    save_artifact(make_toy(), SPEC, tmp_path / "deep/toy.nc", ORIGIN)
    back = open_artifact(tmp_path / "deep/toy.nc", SPEC)
    np.testing.assert_array_equal(back.angle, make_toy().angle)
    assert back.angle.attrs == {"units": "rad", "long_name": "angle"}
    assert back.attrs["stage"] == "play"
    assert back.attrs["inputs"] == '{"angles": "ab"}'
    assert back.attrs["seed"] == 3
    assert "clock" not in back.attrs
    assert back.kept.dtype == bool
    assert back.trial.to_numpy().tolist() == ["a", "b"]


def test_the_same_content_gives_the_same_bytes(tmp_path):
    for name in ("one.nc", "two.nc"):
        save_artifact(make_toy(), SPEC, tmp_path / name, ORIGIN)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


def test_a_wrong_dataset_is_refused_with_all_its_faults(tmp_path):
    wrong = make_toy().drop_vars("kept").assign(surprise=("trial", [1.0, 2.0]))
    wrong["angle"] = wrong.angle.T * 9
    del wrong.attrs["campaign"]
    with pytest.raises(ArtifactFault) as fault:
        save_artifact(wrong, SPEC, tmp_path / "toy.nc", ORIGIN)
    text = str(fault.value)
    assert "variable 'angle' has dims ('frame', 'trial'); expected ('trial', 'frame')" in text
    assert "variable 'angle' contains -9 rad (4 values of 6); expected -3 to 3" in text
    assert "variable 'kept' ('trial',) [1] is missing" in text
    assert "variable 'surprise' is not declared" in text
    assert "attribute 'campaign' is missing" in text
    assert not (tmp_path / "toy.nc").exists()
    assert len(fault.value.faults) == 5


def test_missing_values_are_no_fault():
    holed = make_toy()
    holed["angle"] = holed.angle.where(holed.angle > 0)
    assert list_faults(SPEC, holed) == []


def test_a_wrong_kind_is_a_fault():
    wrong = make_toy().assign(kept=("trial", [0.5, 1.0]))
    assert list_faults(SPEC, wrong) == [
        "variable 'kept' has the type float64; expected truth values"
    ]


def test_another_artifact_and_an_older_version_are_refused(tmp_path):
    save_artifact(make_toy(), SPEC, tmp_path / "toy.nc", ORIGIN)
    with pytest.raises(ArtifactFault, match="'schema' is 'toy'; expected 'other'"):
        open_artifact(tmp_path / "toy.nc", dataclasses.replace(SPEC, name="other"))
    with pytest.raises(ArtifactFault, match="'schema_version' is 1; this program reads 2"):
        open_artifact(tmp_path / "toy.nc", dataclasses.replace(SPEC, version=2))


def test_a_damaged_or_missing_file_is_a_sentence(tmp_path):
    save_artifact(make_toy(), SPEC, tmp_path / "toy.nc", ORIGIN)
    whole = (tmp_path / "toy.nc").read_bytes()
    (tmp_path / "toy.nc").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ArtifactFault, match="does not end in the checksum"):
        open_artifact(tmp_path / "toy.nc", SPEC)
    with pytest.raises(ArtifactFault, match="does not exist"):
        open_artifact(tmp_path / "nowhere.nc", SPEC)


def test_a_failed_save_leaves_the_old_file_and_no_other(tmp_path):
    save_artifact(make_toy(), SPEC, tmp_path / "toy.nc", ORIGIN)
    before = (tmp_path / "toy.nc").read_bytes()
    with pytest.raises(ArtifactFault):
        save_artifact(make_toy() * 100, SPEC, tmp_path / "toy.nc", ORIGIN)
    assert [p.name for p in tmp_path.iterdir()] == ["toy.nc"]
    assert (tmp_path / "toy.nc").read_bytes() == before


def test_a_tree_keeps_its_groups_and_loses_clocks(tmp_path):
    posterior = xr.Dataset({"mu": (("chain", "draw"), np.zeros((2, 5)))})
    posterior.attrs["created_at"] = "now"
    stats = xr.Dataset({"diverging": (("chain", "draw"), np.zeros((2, 5), bool))})
    tree = xr.DataTree.from_dict({"posterior": posterior, "sample_stats": stats})
    save_tree(tree, TREE, tmp_path / "tree.nc", ORIGIN)
    back = open_tree(tmp_path / "tree.nc", TREE)
    assert set(back.children) == {"posterior", "sample_stats"}
    assert "created_at" not in back["posterior"].attrs
    assert back["posterior"]["mu"].attrs["units"] == "1"
    tree["independence"] = xr.Dataset({"p": ((), 0.5)})
    save_tree(tree, TREE, tmp_path / "tree.nc", ORIGIN)
    assert (
        open_tree(tmp_path / "tree.nc", TREE)["independence"]["p"].attrs["long_name"] == "p-value"
    )
    with pytest.raises(ArtifactFault, match="group 'independence': variable 'p' contains 2"):
        save_tree(tree * 4, TREE, tmp_path / "other.nc", ORIGIN)
    del tree["posterior"]
    with pytest.raises(ArtifactFault, match="group 'posterior' is missing"):
        save_tree(tree, TREE, tmp_path / "other.nc", ORIGIN)


def test_declarations_are_complete():
    specs = list_specs()
    assert len({spec.name for spec in specs}) == len(specs)
    for spec in specs:
        groups = [spec.variables, spec.coords, *spec.groups.values()]
        for name, variable in (item for group in groups for item in group.items()):
            assert variable.long_name, f"{spec.name}.{name}"
            assert variable.units, f"{spec.name}.{name}"
