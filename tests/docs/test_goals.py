"""The table of goals with which `make benchmark` ends."""

import json
import os
from importlib import import_module
from pkgutil import iter_modules

import benchmarks
import pytest
from benchmarks import _goals


def test_a_key_that_was_not_measured_is_absent_and_its_command_is_named(capsys):
    _goals.print_table({"tracking_fps": 5000.0, "tracking_fps_of_grey_moments": 9000.0})
    rows = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines()}
    assert rows["tracking_fps"][1:] == ["≥", "4000", "5000", "met", "9000"]
    assert rows["quick_job_seconds"][3:] == ["absent", "make", "benchmark-long"]
    assert set(rows) == {"key", *_goals.GOALS}


def test_a_figure_off_its_goal_is_missed():
    rows = {row[0]: row for row in _goals.list_rows({"tracking_rms_over_crlb": 1.2})}
    assert rows["tracking_rms_over_crlb"][2:4] == ("1.2", "missed")


def test_keys_of_proofs_are_those_of_the_newest_seed(tmp_path):
    for age, (name, share) in enumerate((("seed_7", 0.5), ("seed_2", 0.9))):
        path = tmp_path / "concealed_clean" / name / "benchmarks.json"
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps({"clean_false_alarm_share": share, "concealed_other": 1.0}))
        os.utime(path, (age, age))
    assert _goals.read_proofs(tmp_path) == {"clean_false_alarm_share": 0.9}
    assert _goals.read_proofs(tmp_path / "none") == {}


def test_a_proof_leaves_the_figures_of_other_commands():
    """The proof of clean campaigns took away what `benchmarks.outliers` measures."""
    others = ["clean_with_outliers_adequate_share", "real_campaigns", "tracking_fps"]
    assert [key for key in others for own in _goals.PROOFS.values() if key.startswith(own)] == []


@pytest.mark.parametrize("name", sorted(one.name for one in iter_modules(benchmarks.__path__)))
def test_every_benchmark_can_be_imported(name):
    """A module that another one moved from under its feet would end `make benchmark`."""
    import_module(f"benchmarks.{name}")
