from importlib.metadata import version

from softfinger.doctor import check_folder, check_setup
from softfinger.provenance import environment, environment_hash, hash_files, list_other_versions


def test_a_sound_installation_has_no_complaint(tmp_path):
    findings = list(check_setup(tmp_path))
    assert [finding.what for finding in findings if not finding.well] == []
    assert {"Python", "packages", "video", "compiler", "disk"} == {f.what for f in findings}


def test_packages_that_deviate_from_the_lock_are_named():
    here = version("numpy")
    lock = f"numpy=={here} \\\n    --hash=sha256:00\nscipy==0.1 \\\nnot-there==1.0 \\\n"
    assert list_other_versions(lock) == [
        f"scipy {version('scipy')} instead of 0.1",
        "not-there is missing",
    ]
    assert list_other_versions(lock, missing=False) == [f"scipy {version('scipy')} instead of 0.1"]


def test_a_package_pinned_twice_is_well_at_either_version():
    here = version("numpy")
    lock = (
        f"numpy==0.1 ; python_full_version < '3' \\\n"
        f"numpy=={here} ; python_full_version >= '3' \\\n"
    )
    assert list_other_versions(lock) == []
    assert list_other_versions(lock.replace(here, "0.2")) == [f"numpy {here} instead of 0.1 or 0.2"]


def test_the_disk_is_judged_where_the_results_are_to_come(tmp_path):
    finding = check_folder(tmp_path / "not/yet/there")
    assert finding.said.startswith(str(tmp_path))


def test_other_libraries_are_another_environment(tmp_path, monkeypatch):
    assert environment_hash() == hash_files(environment.LOCK)  # here all are as locked
    (tmp_path / "lock").write_text("numpy==0.1 \\\n")
    monkeypatch.setattr(environment, "LOCK", tmp_path / "lock")
    assert environment.environment_hash.__wrapped__() != hash_files(tmp_path / "lock")
