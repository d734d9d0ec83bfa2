import json

import cv2
import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.reproduction import compare_run, list_files, main, tell, write_manifest

ATTRS = {"code_sha256": "c", "params_sha256": "p", "environment_sha256": "e", "inputs": "i"}


def write_run(folder, angle=1.0, sd=1.0, decision="adequate", **attrs):
    folder.mkdir(exist_ok=True)
    dataset = xr.Dataset(
        {"angle": ("time", angle + sd * np.linspace(-1, 1, 7)), "name": ("trial", ["a", "b"])},
        attrs=ATTRS | {"seed": 1} | attrs,
    )
    for name in ("angles", "bands"):
        dataset.to_netcdf(folder / f"{name}.nc", engine="h5netcdf")
    verdict = {"decision": decision, "effects": [{"id": "gravity"}]}
    (folder / "verdict.json").write_text(json.dumps(verdict))
    (folder / "logs").mkdir(exist_ok=True)
    (folder / "logs/run.csv").write_text("no result")
    return folder


@pytest.fixture
def manifest(tmp_path):
    path = tmp_path / "manifest.json"
    write_manifest(write_run(tmp_path / "first"), path)
    return path


def answer(folder, manifest):
    return {answer.name: answer for answer in compare_run(folder, manifest)}


def test_the_same_run_is_equal(tmp_path, manifest):
    found = answer(write_run(tmp_path / "again"), manifest)
    assert {a.word for a in found.values()} == {"equal"}
    assert set(found) == {"angles.nc", "bands.nc", "verdict.json"}
    assert main("compare", tmp_path / "again", manifest) == 0


def test_other_packages_with_the_same_values_are_named(tmp_path, manifest):
    run = write_run(tmp_path / "again", environment_sha256="other")
    assert answer(run, manifest)["angles.nc"].word == "equal values"
    assert answer(run, manifest)["angles.nc"].why == "changed: the locked packages"


def test_rounding_is_within_tolerance_and_more_is_not(tmp_path, manifest):
    found = answer(write_run(tmp_path / "a", angle=1.0 + 1e-6), manifest)
    assert found["angles.nc"].word == "within tolerance"
    assert "another kind of machine" in found["angles.nc"].why
    found = answer(write_run(tmp_path / "b", angle=1.01), manifest)
    assert not found["angles.nc"].good
    assert found["bands.nc"].good  # hangs on draws
    assert "was" in found["angles.nc"].why


def test_missing_values_count(tmp_path, manifest):
    run = write_run(tmp_path / "again")
    with xr.open_dataset(run / "angles.nc") as opened:
        changed = opened.load()
    changed["angle"][3] = np.nan
    changed.to_netcdf(run / "angles.nc", engine="h5netcdf")
    assert "missing" in answer(run, manifest)["angles.nc"].why


def test_another_verdict_and_a_missing_file_are_different(tmp_path, manifest):
    run = write_run(tmp_path / "again", decision="named")
    (run / "bands.nc").unlink()
    found = answer(run, manifest)
    assert found["verdict.json"].why == "the verdict is named: gravity; was adequate: gravity"
    assert found["bands.nc"].word == "missing"
    assert main("compare", run, manifest) == 1
    assert "1 different" in tell(list(found.values()))


def test_a_file_that_the_manifest_does_not_know_is_told(tmp_path, manifest):
    run = write_run(tmp_path / "again")
    (run / "more.csv").write_text("a")
    assert answer(run, manifest)["more.csv"].word == "new"
    assert "logs/run.csv" not in list_files(run)


def test_a_text_is_compared_by_its_numbers_whatever_hash_it_cites(tmp_path):
    run = write_run(tmp_path / "first")
    (run / "model.yaml").write_text(f"median: 2.5\nsha256: {'a' * 64}\n")
    manifest = tmp_path / "manifest.json"
    write_manifest(run, manifest)
    (run / "model.yaml").write_text(f"median: 2.5\nsha256: {'b' * 64}\n")
    assert answer(run, manifest)["model.yaml"].word == "equal values"
    (run / "model.yaml").write_text("median: 2.5001\n")
    assert answer(run, manifest)["model.yaml"].word == "within tolerance"
    (run / "model.yaml").write_text("median: 2.6\n")
    assert answer(run, manifest)["model.yaml"].word == "different"


def test_a_video_is_compared_by_what_it_shows(tmp_path):
    for folder, grey in (("first", 100), ("codec", 101), ("dark", 50)):
        (tmp_path / folder).mkdir()
        path = str(tmp_path / folder / "video.avi")
        writer = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (64, 48))
        shade = grey + np.arange(64, dtype=np.uint8)
        writer.write(np.tile(shade[None, :, None], (48, 1, 3)))
        writer.release()
    write_manifest(tmp_path / "first", tmp_path / "manifest.json")
    words = [
        answer(tmp_path / folder, tmp_path / "manifest.json")["video.avi"].word
        for folder in ("first", "codec", "dark")
    ]
    assert words == ["equal", "within tolerance", "different"]


def test_faults(tmp_path, manifest):
    with pytest.raises(Fault, match="make manifest"):
        list(compare_run(tmp_path, tmp_path / "none.json"))
    manifest.write_text(json.dumps({"version": 9}))
    with pytest.raises(Fault, match="version 9"):
        list(compare_run(tmp_path, manifest))
