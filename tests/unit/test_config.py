from pathlib import Path

import pytest

from softfinger.config import SCHEMA_FILE, read_config
from softfinger.faults import ListedFault
from softfinger.provenance import PROJECT
from softfinger.schema import Configuration, format_schema
from softfinger.settings import read_settings


def test_the_committed_schema_is_the_present_one():
    renew = f"run: python -m softfinger.schema {SCHEMA_FILE.relative_to(PROJECT)}"
    assert SCHEMA_FILE.read_text(encoding="utf-8") == format_schema(), renew


@pytest.mark.parametrize("file", [None, PROJECT / "config/quick.yaml"])
def test_the_committed_configurations_are_whole(file):
    read_settings(Configuration, read_config(file), "file")


def test_a_file_replaces_single_keys(tmp_path: Path):
    (tmp_path / "own.yaml").write_text("virtual_rig: {n_trials: 7}\n")
    config = read_config(tmp_path / "own.yaml")
    assert config["virtual_rig"]["n_trials"] == 7
    assert config["virtual_rig"]["fps"] == read_config()["virtual_rig"]["fps"]


def test_all_faults_of_a_configuration_are_listed(tmp_path: Path):
    (tmp_path / "own.yaml").write_text("sede: 1\nestimation: {chains: 0}\n")
    with pytest.raises(ListedFault) as fault:
        read_config(tmp_path / "own.yaml")
    assert "'sede' was unexpected" in str(fault.value)
    assert "estimation.chains: 0 is less than the minimum of 2" in str(fault.value)
