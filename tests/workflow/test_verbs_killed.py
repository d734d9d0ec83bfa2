"""Verbs are killed at random moments; the next call ends as if nothing had been."""

import shutil
import time

import numpy as np
import pytest
from tests.workflow.killing import PROJECT, SIGNALS, SMALL, check_whole, kill, read_results, start

EXAMPLE = PROJECT / "data/example"
# Each verb with the folder that it writes, and how many kills.
VERBS = {
    "virtual-rig": (["--out", "rig"], "rig", 2),
    "track": (["rig/campaign", "--out", "filmed"], "filmed", 5),
    "angles": ([EXAMPLE, "--out", "out"], "out", 2),
    "fit": ([EXAMPLE, "--out", "out"], "out", 5),
    "propagate": ([EXAMPLE, "--out", "out"], "out", 2),
    "diagnose": ([EXAMPLE, "--out", "out"], "out", 5),
    "report": ([EXAMPLE, "--out", "out"], "out", 1),
    "loop": ([EXAMPLE, "--out", "loop", "--rig", "false {plan} {out}"], "loop", 3),
}
# With a rig that never records, `loop` ends after its first round, unless that settles it.
MAY_REFUSE = {"loop"}


@pytest.mark.slow
def test_verbs_that_are_killed_end_as_if_nothing_had_been(tmp_path):
    rng = np.random.default_rng(5)
    (tmp_path / "small.yaml").write_text(SMALL)
    kills = 0
    for verb, (arguments, out, count) in VERBS.items():
        command = [verb, *arguments, "--config", "small.yaml"]
        before = tmp_path / "before"
        shutil.rmtree(before, ignore_errors=True)
        if (tmp_path / out).exists():
            shutil.copytree(tmp_path / out, before)
        began = time.monotonic()
        status = start(tmp_path, *command).wait()
        assert status in {0, *([1] if verb in MAY_REFUSE else [])}, verb
        took = time.monotonic() - began
        expected = read_results(tmp_path / out)
        shutil.rmtree(tmp_path / out)
        if before.exists():
            shutil.copytree(before, tmp_path / out)
        for _ in range(count):
            running = start(tmp_path, *command)
            time.sleep(rng.uniform(0.2, 0.95) * took)
            kill(running, SIGNALS[kills % len(SIGNALS)], tmp_path)
            for folder in [tmp_path / out, *(tmp_path / out).glob("round_*/results")]:
                check_whole(folder)
            kills += 1
        assert start(tmp_path, *command).wait() == status, verb
        found = read_results(tmp_path / out)
        assert sorted(found) == sorted(expected), verb
        assert [name for name in found if found[name] != expected[name]] == [], verb
    assert kills >= 24
