"""`softfinger run` is killed at random moments; the next one goes on as if nothing had been."""

import time

import numpy as np
import pytest
from tests.workflow.killing import PROJECT, SIGNALS, SMALL, check_whole, kill, start

KILLS = 20
LONGEST_S = 40.0
EXAMPLE = PROJECT / "data/example"


def run(folder, out):
    return start(folder, "run", EXAMPLE, "--out", out, "--config", "small.yaml")


@pytest.mark.slow
def test_killed_twenty_times_it_ends_as_if_nothing_had_been(tmp_path):
    (tmp_path / "small.yaml").write_text(SMALL)
    assert run(tmp_path, "whole").wait() == 0
    rng = np.random.default_rng(7)
    for number in range(KILLS):
        running = run(tmp_path, "killed")
        time.sleep(rng.uniform(0.5, LONGEST_S))
        kill(running, SIGNALS[number % len(SIGNALS)], tmp_path)
        check_whole(tmp_path / "killed")
    assert run(tmp_path, "killed").wait() == 0
    names = sorted(path.name for path in (tmp_path / "whole").glob("*.nc"))
    assert len(names) >= 8
    for name in names:
        whole, killed = (tmp_path / out / name for out in ("whole", "killed"))
        assert killed.read_bytes() == whole.read_bytes(), name
    assert not list((tmp_path / "killed").rglob("*.partial*"))
