"""Layouts that were read wrongly once: each is read as it is, or refused in a sentence."""

import numpy as np
import pytest

from softfinger.importing import ImportFault, ImportFaults

TIME = np.arange(60) * 0.5
MOTION = 3.0 * (1 - np.exp(-TIME))
LOAD = np.where(TIME < 0.5, 0.0, 2.0)
ANGLES = np.outer(np.deg2rad([10.0, 20.0, 30.0]), 1 - np.exp(-TIME))
PLACES = np.cumsum(
    [[np.zeros(60), 20 + np.zeros(60)]]
    + [[np.cos(q), np.sin(q)] for q in (0 * TIME, *np.cumsum(ANGLES, axis=0))],
    axis=0,
)  # (point, axis, row): points of a chain with links of length 1


def rows(form, *columns):
    return "".join(form.format(*values) + "\n" for values in zip(*columns, strict=True))


def check(trial, motion=MOTION, load=LOAD, time=TIME):
    np.testing.assert_allclose(trial.time, time, atol=1e-9)
    np.testing.assert_allclose(trial.motion[:, 0], motion, atol=1e-6)
    np.testing.assert_allclose(np.interp(trial.time, trial.load_time, trial.load), load)


def check_chain(trial, up=-1.0):
    """The chain's angles, of points that a picture or a room counts downwards or upwards."""
    place = trial.motion.reshape(60, -1, 2) * [1.0, up]
    turned = np.unwrap(np.arctan2(*np.diff(place, axis=1).transpose(2, 1, 0)[::-1]), axis=1)
    np.testing.assert_allclose(np.abs(np.diff(turned, axis=0)), ANGLES, atol=1e-6)


def test_intervals_of_a_rheometer_are_one_trial_until_its_clock_starts_anew(write, read):
    def interval(number, first, last):
        head = f"Interval and data points:\t{number}\t{last - first}\n"
        head += "Interval data:\tPoint No.\tTime\tShear Strain\tShear Stress\n"
        head += "\t\t\t\t\n\t\t[s]\t[%]\t[Pa]\n"
        data = zip(TIME[first:last], MOTION[first:last], LOAD[first:last], strict=True)
        return head + "".join(
            "\t".join(["", str(k), *(f"{v:.6f}".replace(".", ",") for v in row)]) + "\n"
            for k, row in enumerate(data, start=1)
        )

    def test(name):
        both = interval(1, 0, 30) + interval(2, 30, 60)
        return f"Test:\t{name}\nResult:\t{name} 1\n\n{both}\n"

    text = "Project:\tSkin of a soft finger\n\n" + test("Creep DS10 1") + test("Creep DS10 2")
    found = read(write("creep.csv", text.encode("utf-16")))
    assert len(found.trials) == 2
    for trial in found.trials:
        check(trial)
    assert found.description.motion.unit == "%"
    assert found.description.load.quantity == "stress"


def test_steps_of_a_file_are_joined_where_its_clock_goes_on(write, read):
    heading = "Time\tStress\tStrain\tAxial force\ns\tPa\t%\tN\n"
    wobble = 0.01 * np.sin(9.0 * TIME)
    parts = [
        f"[step]\n{name}\n{heading}"
        + rows("{}\t{}\t{}\t{}", TIME[part], LOAD[part], MOTION[part], wobble[part])
        for name, part in (("Creep", slice(0, 30)), ("Recovery", slice(30, 60)))
    ]
    text = "Filename\ta.tri\nGap\t1000 um\n\n" + "\n".join(parts)
    for number in (1, 2):
        path = write(f"Ecoflex {number}.txt", text)
    found = read(path)
    assert [trial.name for trial in found.trials] == ["Ecoflex 1", "Ecoflex 2"]
    check(found.trials[0])
    assert found.description.load.column == "Stress"
    by_file = read(path, "trials.by=file")
    check(by_file.trials[0])


def test_a_rate_divides_no_clock_of_another_file(write, read):
    points = "".join(f",p{k} x,p{k} y" for k in range(len(PLACES)))
    film = rows("{:.0f}" + ",{}" * 2 * len(PLACES), np.arange(60), *PLACES.reshape(-1, 60))
    for run in (1, 2):
        write(f"run{run}/videoDLC_resnet50.csv", f"frame{points}\n{film}")
        cell = write(f"run{run}/loadcell.csv", "Time (ms),Force (N)\n" + rows(
            "{},{}", 1000 * TIME, LOAD))  # fmt: skip
    found = read(cell, "clock.frames_per_second=2")
    assert len(found.trials) == 2
    np.testing.assert_allclose(found.trials[0].load_time, TIME)
    np.testing.assert_allclose(found.trials[0].time, TIME)
    check_chain(found.trials[0])


def test_a_clock_of_whole_seconds_gives_way_to_an_interval(write, read):
    text = "Time,Extension (mm),Force (N)\n" + rows("10:00:{:02.0f},{},{}", TIME // 1, MOTION, LOAD)
    path = write("a.csv", text)
    with pytest.raises(ImportFaults, match=r"2 rows at each time.*interval_s: 0.5"):
        read(path)
    check(read(path, "clock.interval_s=0.5").trials[0])


def test_a_row_for_each_joint_gives_each_joint_a_column(write, read):
    lines = [
        f"{trial};{t};J{j};{np.rad2deg(ANGLES[j - 1][k]):.9f};{LOAD[k]}\n"
        for trial in ("t1", "t2")
        for k, t in enumerate(TIME)
        for j in (1, 2, 3)
    ]
    found = read(write("tidy.csv", "trial;time;joint;angle_deg;tension_N\n" + "".join(lines)))
    assert [trial.name for trial in found.trials] == ["t1", "t2"]
    for trial in found.trials:
        np.testing.assert_allclose(trial.motion.T, ANGLES, atol=1e-9)
        np.testing.assert_allclose(trial.load, LOAD)


def test_rotation_vectors_are_no_places(write, read):
    names = "t,id,rvec_x,rvec_y,rvec_z,tvec_x,tvec_y,tvec_z"
    lines = [
        f"{t},{k},0.1,3.1,0.{k},{x},{y},5.0\n"
        for i, t in enumerate(TIME)
        for k, (x, y) in enumerate(PLACES[:, :, i])
    ]
    found = read(write("aruco.csv", names + "\n" + "".join(lines)), "load.none=true")
    assert found.description.motion.points.names == ("0", "1", "2", "3", "4")


def test_a_chain_in_an_upright_plane_is_seen_in_it(write, read):
    names = ",".join(f"p{k} {axis}" for k in range(len(PLACES)) for axis in "xyz")
    places = [c for x, z in PLACES for c in (x, np.full(60, 7.0), z)]
    text = f"time,{names}\n" + rows("{}" + ",{}" * len(places), TIME, *places)
    check_chain(read(write("a.csv", text), "load.none=true").trials[0])


def test_an_event_log_holds_its_load_until_the_next_row(write, read):
    time = np.arange(0.0, 12.0, 0.05)
    for run in (1, 2):
        write(f"{run}/imu.csv", "time,roll,pitch\n" + rows(
            "{},{},{}", time, 0.001 * np.sin(time), 0.3 * (time > 2.0)))  # fmt: skip
        path = write(f"{run}/valve.csv", "time,pressure (kPa)\n0,0\n2,20\n8,0\n")
    found = read(path)
    trial = found.trials[0]
    np.testing.assert_allclose(trial.load_time, [0, 2, 2, 8, 8])
    np.testing.assert_allclose(trial.load, [0, 0, 20, 20, 0])
    assert found.description.motion.columns == ("imu: pitch",)
    assert any("load.between: held" in said for said in found.guessed)
    straight = read(path, "load.between=line")
    np.testing.assert_allclose(straight.trials[0].load, [0, 20, 0])


@pytest.mark.parametrize(
    ("code", "names"),
    [
        ("shift_jis", ("時間", "ストローク 変位", "試験力 荷重")),
        ("gb18030", ("时间", "位移", "力（N）")),
        ("utf-8", ("Zeit", "Weg", "Kraft")),
    ],
)
def test_the_encoding_is_that_in_which_known_words_appear(write, read, code, names):
    text = ",".join(names) + "\n" + rows("{},{},{}", TIME, MOTION, LOAD)
    check(read(write("a.csv", text.encode(code))).trials[0])


def test_columns_that_repeat_are_trials(write, read):
    text = "Time,Force,Extension,Time,Force,Extension\n"
    text += rows("{},{},{},{},{},{}", TIME, LOAD, MOTION, TIME, LOAD, 2 * MOTION)
    found = read(write("a.csv", text))
    check(found.trials[0])
    check(found.trials[1], 2 * MOTION)


def test_names_with_their_values_are_a_table(write, read):
    text = "Ready.\n" + "".join(
        f"14:01:02.345 -> t={1000 * t:.0f} ms, F={f} N, th1={a[0]}, th2={a[1]}, th3={a[2]}\n"
        for t, f, a in zip(TIME, LOAD, ANGLES.T, strict=True)
    )
    found = read(write("serial.txt", text), "motion.unit=rad")
    np.testing.assert_allclose(found.trials[0].motion.T, ANGLES)
    np.testing.assert_allclose(found.trials[0].time, TIME)
    assert found.description.load.unit == "N"


def test_the_newest_row_may_come_first(write, read):
    text = "Time,Extension (mm),Force (N)\n"
    text += rows("{},{},{}", TIME[::-1], MOTION[::-1], LOAD[::-1])
    found = read(write("a.csv", text))
    check(found.trials[0])
    assert any("runs backwards" in said for said in found.dropped)


def test_units_are_known_beside_a_word_that_is_none(write, read):
    text = "Time,Axial Count,Displacement,Force\nSec,segments,mm,kN\n"
    text += rows("{},{:.0f},{},{}", TIME, np.ones(60), MOTION, LOAD)
    found = read(write("a.dat", text))
    check(found.trials[0])
    assert (found.description.motion.unit, found.description.load.unit) == ("mm", "kN")


def test_a_declared_unit_that_is_not_the_heading_s_is_noted(write, read):
    text = "Time (s),Extension (µm),Force (N)\n" + rows("{},{},{}", TIME, MOTION, LOAD)
    found = read(write("a.csv", text), "motion.unit=mm")
    assert any("the heading states µm" in said for said in found.guessed)


def test_temperature_and_minus_signs_do_no_harm(write, read):
    text = "t (s),T (°C),θ1 (°),M (N·mm)\n"
    text += rows("{},25.0,{},{}", TIME, [f"\N{MINUS SIGN}{m:.9f}" for m in MOTION], LOAD)
    found = read(write("a.csv", text))
    check(found.trials[0], np.deg2rad(MOTION))


def test_arrays_in_cells_have_a_column_for_each_number(write, read):
    lines = [
        f'{t},"({a[0]}, {a[1]}, {a[2]})",{f}\n'
        for t, a, f in zip(TIME, ANGLES.T, LOAD, strict=True)
    ]
    names = ", ".join(f"position {k}" for k in (1, 2, 3))
    found = read(
        write("bag.csv", "Time,position,tension\n" + "".join(lines)),
        "trials.by=file", f"motion.columns=[{names}]", "motion.quantity=angle", "motion.unit=rad",
    )  # fmt: skip
    np.testing.assert_allclose(found.trials[0].motion.T, ANGLES)


@pytest.mark.parametrize("named", [r"\t", "tab"])
def test_a_tab_may_be_typed_by_name(write, read, named):
    text = "Time\tExtension\tForce\n" + rows("{}\t{}\t{}", TIME, MOTION, LOAD)
    check(read(write("a.csv", text), f"tables.delimiter={named}").trials[0])


def test_a_delimiter_of_several_characters_is_refused(write, read):
    with pytest.raises(ImportFaults, match="expected one character, or tab or space"):
        read(write("a.csv", "Time::Force\n"), "tables.delimiter='::'")


def test_several_columns_of_a_specimen_are_refused(write, read):
    text = "Time,a,b,Force\n" + rows("{},{},{},{}", TIME, MOTION, MOTION, LOAD)
    with pytest.raises(ImportFault, match=r"2 columns .* a specimen has one"):
        read(write("a.csv", text), "motion.columns=[a, b]", "motion.unit=mm")


def test_a_summary_below_dates_may_be_named_as_a_gap(write, read):
    stamps = [f"2024-03-01 10:00:{t:06.3f}" for t in TIME]
    text = "Date,Extension,Force\n" + rows("{},{},{}", stamps, MOTION, LOAD) + "Average,1.0,2.0\n"
    path = write("a.csv", text)
    with pytest.raises(ImportFault, match=r"missing: \['Average'\]"):
        read(path)
    check(read(path, "tables.missing=[Average]").trials[0])


def test_of_numbered_columns_the_first_is_read_with_the_first_load(write, read):
    text = "Time,F1 (N),F2 (N),d1 (mm),d2 (mm)\n"
    text += rows("{},{},{},{},{}", TIME, LOAD, 2 * LOAD, MOTION, 2 * MOTION)
    check(read(write("a.csv", text), "trials.by=file").trials[0])


def test_a_clock_starts_anew_beyond_a_line_of_words(write, read):
    text = "Time,Extension,Force\n" + rows("{},{},{}", TIME, MOTION, LOAD)
    text += "Trial 2,,\n" + rows("{},{},{}", TIME, 2 * MOTION, LOAD)
    path = write("a.csv", text)
    with pytest.raises(ImportFault, match=r"missing: \['Trial 2'\]"):
        read(path)
    first, second = read(path, "tables.missing=[Trial 2]").trials
    check(first)
    check(second, 2 * MOTION)
