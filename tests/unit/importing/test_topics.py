"""Files of one trial, and trials of one table, by whatever their names say."""

import numpy as np
import pytest

from softfinger.importing import ImportFault

TIME = np.arange(60) * 0.5
SIZES = (1.0, 2.0, 5.0)


def move(size):
    """Motion [mm] and load [N] of a trial."""
    return 3.0 * size * (1 - np.exp(-TIME)), np.where(TIME < 0.5, 0.0, size)


def write_rows(heading, *columns):
    lines = (",".join(f"{value:.6f}" for value in row) for row in zip(*columns, strict=True))
    return heading + "\n" + "\n".join(lines) + "\n"


def check(found, sizes=SIZES, factor=1.0):
    assert len(found.trials) == len(sizes)
    for trial, size in zip(found.trials, sizes, strict=True):
        motion, load = move(size)
        np.testing.assert_allclose(trial.time, TIME, atol=1e-6)
        np.testing.assert_allclose(trial.motion[:, 0], factor * motion, atol=1e-5)
        np.testing.assert_allclose(np.interp(trial.time, trial.load_time, trial.load), load)


@pytest.mark.parametrize("name", ["trial{}_{}.csv", "{1}_{0}.csv", "day 1/{}/{}.csv"])
def test_files_of_one_number_are_topics_of_a_trial(write, read, name):
    for k, size in enumerate(SIZES, start=1):
        motion, load = move(size)
        write(name.format(k, "camera"), write_rows("time_s,disp_mm", TIME, motion))
        source = write(name.format(k, "load"), write_rows("time_s,force_N", TIME, load))
    check(read(source))


@pytest.mark.parametrize(("of_load", "factor"), [("t[ms]", 1e3), ("t [min]", 1 / 60)])
def test_each_file_of_a_trial_has_the_unit_of_its_own_clock(write, read, of_load, factor):
    for k, size in enumerate(SIZES, start=1):
        motion, load = move(size)
        write(f"run{k}/camera.csv", write_rows("t,disp_mm", TIME, motion))
        clock = np.where(TIME == 0.5, 0.5 + 1e-9, TIME) * factor
        source = write(f"run{k}/load.csv", write_rows(f"{of_load},force_N", clock, load))
    found = read(source)
    assert len(found.trials) == len(SIZES)
    for trial in found.trials:
        assert trial.load_time[-1] == pytest.approx(TIME[-1], abs=1e-3)


@pytest.mark.parametrize(
    "own",
    [("F{} (N)", "d{} (mm)"), ("Force A7-{} (N)", "Disp A7-{} (mm)"), ("{}a (N)", "{}b (mm)")],
)
def test_columns_from_one_clock_to_the_next_are_one_trial(write, read, own):
    """Every trial was the first, for its clock alone has the name of the others."""
    heading, columns = [], []
    for k, size in enumerate(SIZES, start=1):
        heading += ["Time (s)", *(name.format(k) for name in own)]
        columns += [TIME, *reversed(move(size))]
    keys = ["load.quantity=force", "motion.quantity=displacement"]
    keys += [] if own[0][0] in "F" else ["load.column=1a", "motion.columns=[1b]"]
    check(read(write("all.csv", write_rows(",".join(heading), *columns)), *keys))


def test_columns_that_end_in_a_number_are_trials_beside_a_clock(write, read):
    heading, columns = ["Time"], [TIME]
    for k, size in enumerate(SIZES, start=1):
        heading += [f"F{k}", f"d{k}"]
        columns += reversed(move(size))
    units = ",".join(["s", *["N", "mm"] * len(SIZES)])
    check(read(write("all.csv", write_rows(",".join(heading) + "\n" + units, *columns))))


def test_numbers_within_merged_headings_are_those_of_the_groups(write_book, read):
    upper, heading, columns = [""], ["Time (s)"], [TIME]
    for k, size in enumerate(SIZES, start=1):
        upper += [f"Specimen {k}", ""]
        heading += [f"F{k} (N)", f"d{k} (mm)"]
        columns += reversed(move(size))
    rows = [upper, heading, *([float(v) for v in row] for row in zip(*columns, strict=True))]
    merged = ["B1:C1", "D1:E1", "F1:G1"]
    check(read(write_book("all.xlsx", {"Data": rows}, merged=merged)))


def test_blocks_that_wait_longer_than_they_last_are_trials(write, read):
    text = "Project\tSkin\n"
    for k, size in enumerate(SIZES):
        text += f"Scan {k + 1}\n"
        body = write_rows("Time,Disp,Load\nSec,mm,N", TIME + 600.0 * k, *move(size))
        text += body.replace(",", "\t") + "\n"
    found = read(write("scans.txt", text))
    assert len(found.trials) == len(SIZES)
    assert [trial.load.max() for trial in found.trials] == pytest.approx(SIZES)


@pytest.mark.parametrize(
    ("day", "first"), [("3/5/2024", "12:00:{:06.3f} PM"), ("2024-03-05", "12:00:{:06.3f}")]
)
def test_a_date_and_a_time_of_day_are_one_clock(write, read, day, first):
    for k, size in enumerate(SIZES):
        text = "Date,Time,Pitch (deg),Force (N)\n"
        for time, *values in zip(TIME, *move(size), strict=True):
            text += f"{day},{first.format(time)},{values[0]:.6f},{values[1]:.6f}\n"
        source = write(f"run{k}.csv", text)
    found = read(source)
    check(found, factor=np.pi / 180)
    assert [str(trial.started_at)[:10] for trial in found.trials] == ["2024-03-05"] * 3


def test_units_above_the_headings_are_those_of_the_columns(write, read):
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        head = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\n"
        head += "Channels\t2\t\nSamples\t60\t60\nY_Unit_Label\tkPa\tdeg\n"
        head += "X_Dimension\tTime\tTime\n***End_of_Header***\t\t\n"
        body = write_rows("X_Value,Pressure,Bend", TIME, load, motion).replace(",", "\t")
        source = write(f"test_{k}.lvm", head + body)
    found = read(source)
    check(found, factor=np.pi / 180)
    assert (found.description.load.unit, found.description.motion.unit) == ("kPa", "deg")


def test_clocks_that_have_nothing_in_common_start_at_once(write, read):
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        write(f"run{k}/camera.csv", write_rows("time_s,disp_mm", TIME, motion))
        stamps = 1.7096402e12 + 1e5 * k + 1e3 * TIME
        source = write(f"run{k}/load.csv", write_rows("epoch_ms,force_N", stamps, load))
    found = read(source)
    check(found)
    assert found.description.clock.start == "each first row"


def test_a_load_is_the_axis_that_moves_and_a_motion_follows_it(write, read):
    """An axis of noise began at rest; an angle that drifts moves farther."""
    rng = np.random.default_rng(1)
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        noise = 0.02 * rng.standard_normal((3, 60))
        noise[:, 0] = 0.0
        yaw = (40.0 * TIME + 170.0) % 360.0 - 180.0
        columns = [TIME, noise[0], noise[1], load, noise[2], yaw, motion]
        heading = "time_s,force.x,force.y,force.z,torque.x,yaw_deg,pitch_deg"
        source = write(f"run{k}.csv", write_rows(heading, *columns))
    found = read(source)
    assert found.description.load.column == "force.z"
    assert found.description.motion.columns == ("pitch",)


@pytest.mark.parametrize("axes", ["xyzw", "0xyz"])
def test_a_quaternion_is_the_angle_by_which_it_turns(write, read, axes):
    tilt = np.array([0.5, 0.5, -0.5, 0.5])  # of the base; the scalar last
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        half = np.deg2rad(motion) / 2
        x, y, z, w = (tilt[i] * np.cos(half) for i in range(4))
        turn = np.stack([w, z, -y, -x])  # tilt times a turn about its own x
        turned = np.stack([x, y, z, w]) + np.tan(half) * turn
        parts = dict(zip("xyzw", turned, strict=True))
        parts["0"] = parts["w"]
        columns = [TIME, *(parts[axis] for axis in axes), load]
        heading = ",".join(["time_s", *(f"orientation.{axis}" for axis in axes), "force_N"])
        source = write(f"run{k}.csv", write_rows(heading, *columns))
    check(read(source), factor=np.pi / 180)


def test_columns_without_names_are_asked_for(write, read):
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        rows = write_rows("", TIME, load, motion).lstrip()
        source = write(f"data{k}.csv", rows)
    with pytest.raises(ImportFault, match="If column 2 jumps as a load does"):
        read(source)
    keys = "load.column='column 2'", "motion.columns=['column 3']"
    check(read(source, *keys, "load.unit=N", "motion.unit=mm"))


def test_channels_below_the_headings_are_none_and_overload_is_a_gap(write, read):
    for k, size in enumerate(SIZES):
        motion, load = move(size)
        head = "HBM_CATMAN_DATAFILE\n\nTime [s]\tForce [N]\tDisp [mm]\n"
        head += "S/N: 1234\tMX440B channel 1\tMX440B channel 2\n"
        body = write_rows("", TIME, load, motion).lstrip().replace(",", "\t").splitlines()
        for row, word in ((20, "Overflow"), (30, "OVLD"), (40, "–")):
            body[row] = body[row].rpartition("\t")[0] + f"\t{word}"
        source = write(f"run{k}.txt", head + "\n".join(body) + "\n")
    found = read(source)
    for trial, size in zip(found.trials, SIZES, strict=True):
        lost = np.isin(np.arange(60), (20, 30, 40))
        np.testing.assert_array_equal(np.isnan(trial.motion[:, 0]), lost)
        np.testing.assert_allclose(trial.motion[~lost, 0], move(size)[0][~lost], atol=1e-5)
