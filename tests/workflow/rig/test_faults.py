"""Whatever breaks: a clear sentence, a slack wire, and every finished trial whole."""

import os
import resource
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager

import pytest
from ruamel.yaml import YAML

from softfinger.campaign import check_campaign
from softfinger.faults import Fault
from softfinger.rig.cli import record
from softfinger.rig.link import SerialLink
from softfinger.rig.recorder import record_campaign

COMMAND = (sys.executable, "-c", "from softfinger.rig.cli import app; app()")


@contextmanager
def everything_stays_safe(rig, folder, read_files, reason="request"):
    """The wire was pulled inside and let go for this reason; the finished trial is as it was."""
    before, since = read_files(folder), len(rig.read_transcript())
    yield since
    said = rig.wait_for("name=released", since)
    assert f"reason={reason}" in said
    transcript = rig.read_transcript()[since:]
    pulled = next(i for i, line in enumerate(transcript) if " start*" in line)
    assert pulled < transcript.index(said)
    assert not any(" arm " in line for line in transcript[transcript.index(said) :])
    assert read_files(folder) == before
    assert check_campaign(folder) == {}


@pytest.mark.parametrize(
    ("fault", "said", "reason"),
    [
        ("garbage", r"has no checksum.*; check the cable", "request"),
        ("partial_line", r"has the checksum.*; check the cable", "request"),
        ("wrong_checksum", r"has the checksum.*its text gives", "request"),
        ("overshoot", r"the tension was above the limit|tension is 1\d\d N, above", "limit"),
        ("ignored_overshoot", r"tension is 1\d\d N, above.*12 N", "request"),
        ("camera_dies", r"camera virtual:.* is gone", "request"),
    ],
)
def test_a_fault_in_mid_trial(rig, long_plan, half_done, read_files, fault, said, reason):
    with everything_stays_safe(rig, half_done, read_files, reason):
        rig.rehearse(fault)
        with pytest.raises(Fault, match=said + ".*; the wire is released"):
            rig.record(long_plan, half_done)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("stall", r"tension was sampled for 0.2. s of a pull of 2.00 s"),
        ("camera_drops", r"lost .* frames, more than the share .*0.05"),
    ],
)
def test_a_trial_with_holes_is_not_kept(rig, plan_file, half_done, read_files, fault, said):
    with everything_stays_safe(rig, half_done, read_files):
        rig.rehearse(fault)
        with pytest.raises(Fault, match=said + ".*; the wire is released"):
            rig.record(plan_file, half_done)


def test_a_stream_that_stalls_is_not_waited_for(rig, plan_file, tmp_path):
    plan = YAML(typ="safe").load(plan_file)
    plan["safety"]["stream_timeout_s"] = 0.5
    plan["profiles"] = [{"name": "long", "shape": "steps", "levels_n": [8.0], "hold_s": 60.0}]
    YAML().dump(plan, tmp_path / "plan.yaml")
    since = len(rig.read_transcript())
    rig.rehearse("stall")
    with pytest.raises(Fault, match=r"no sample of the tension for 0.5 s.*; the wire is released"):
        rig.record(tmp_path / "plan.yaml", tmp_path / "c")
    assert "reason=request" in rig.wait_for("name=released", since)
    assert not (tmp_path / "c/trials.csv").exists()


def test_a_cable_pulled_in_mid_trial(rig_of_its_own, long_plan, half_done, read_files):
    with everything_stays_safe(rig_of_its_own, half_done, read_files, "heartbeat"):
        rig_of_its_own.rehearse("unplug")
        with pytest.raises(Fault, match=r"is gone .*plug the cable.*watchdog releases it 2.5 s"):
            rig_of_its_own.record(long_plan, half_done)


def test_a_recorder_killed_in_mid_trial(rig, long_plan, half_done, read_files):
    with everything_stays_safe(rig, half_done, read_files, "heartbeat") as since:
        options = [f"--out={half_done}", f"--port={rig.port}", f"--camera={rig.camera}"]
        recorder = subprocess.Popen([*COMMAND, "record", str(long_plan), *options])
        try:
            rig.wait_for(" start*", since)
        finally:
            recorder.kill()
            recorder.wait()
    assert recorder.returncode == -signal.SIGKILL


@pytest.fixture
def restored_signals():
    before = {n: signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    # Where the tests run in the background of a shell, Ctrl-C has been switched off.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("restored_signals")
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_or_a_polite_kill_in_mid_trial(rig, long_plan, half_done, read_files, sent):
    def interrupt(since):
        rig.wait_for(" start*", since)
        os.kill(os.getpid(), sent)

    with everything_stays_safe(rig, half_done, read_files) as since:
        waiting = threading.Thread(target=interrupt, args=(since,))
        waiting.start()
        with pytest.raises(Fault, match="interrupted; the wire is released"):
            record(long_plan, half_done, rig.port, rig.camera, ["humidity_pct=40"])
        waiting.join()


def test_a_disk_that_fills_up(rig, plan_file, half_done, read_files):
    """A file may not grow beyond what the first trial's video needed; the second's is longer."""
    first = (half_done / "video/trial_001.avi").stat().st_size
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    with everything_stays_safe(rig, half_done, read_files):
        resource.setrlimit(resource.RLIMIT_FSIZE, (first, limit[1]))
        try:
            with pytest.raises(Fault, match=r"trial_002.avi: it cannot be written.*disk.*released"):
                rig.record(plan_file, half_done)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limit)


def test_a_port_that_is_missing_or_busy(rig, plan_file, tmp_path):
    with pytest.raises(Fault, match=r"port /dev/absent cannot be opened .*ports found here"):
        record_campaign(plan_file, tmp_path / "c", "/dev/absent", rig.camera, {})
    with (
        SerialLink(rig.port),
        pytest.raises(Fault, match=r"is busy: another program uses it"),
    ):
        rig.record(plan_file, tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_firmware_of_another_version(rig, plan_file, tmp_path):
    rig.rehearse("wrong_version")
    with pytest.raises(Fault, match=r"speaks version 999 .* program version 1; install"):
        rig.record(plan_file, tmp_path / "c")
    assert not (tmp_path / "c").exists()
