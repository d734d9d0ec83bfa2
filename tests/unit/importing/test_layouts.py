"""Layouts of recordings, made up: every one is read without a word of description, but a rate."""

import datetime as dt

import h5py
import numpy as np
import pytest
import xarray as xr

TIME = np.arange(12) * 0.5
MOTION = 3.0 * (1 - np.exp(-TIME))
LOAD = np.where(TIME < 0.5, 0.0, 2.0)


def rows(form, *columns, start=0):
    return "".join(
        form.format(*values) + "\n" for values in list(zip(*columns, strict=True))[start:]
    )


def check(trial, motion=MOTION, load=LOAD, time=TIME):
    np.testing.assert_allclose(trial.time, time, atol=1e-9)
    np.testing.assert_allclose(trial.motion[:, 0], motion, atol=1e-6)
    if load is not None:
        np.testing.assert_allclose(np.interp(trial.time, trial.load_time, trial.load), load)


def comma(value):
    return f"{value:.9g}".replace(".", ",")


def test_decimal_commas_semicolons_preamble_and_unit_row(write, read):
    data = rows("{};{};{}", *([comma(v) for v in column] for column in (TIME, MOTION, LOAD)))
    text = "Prüfer;Müller\nNorm;EN 123\n\nZeit;Weg;Kraft\n[s];[mm];[kN]\n" + data
    found = read(write("a.csv", text.encode("cp1252")))
    check(found.trials[0])
    assert (found.description.motion.unit, found.description.load.unit) == ("mm", "kN")


def test_spaces_of_any_number_below_a_comment(write, read):
    text = "# made by a rig\n# t  angle_deg  torque_Nmm\n" + rows("{}   {}  {}", TIME, MOTION, LOAD)
    found = read(write("a.dat", text))
    check(found.trials[0], np.deg2rad(MOTION))
    assert found.description.load.unit == "N*mm"


def test_utf_16_with_tabs_and_thousands(write, read):
    big = [f"{1000 * m + 5000:,.3f}" for m in MOTION]
    text = "Time (ms)\tElongation (µm)\tForce (N)\n" + rows("{}\t{}\t{}", 1000 * TIME, big, LOAD)
    found = read(write("a.txt", text.encode("utf-16")), "motion.start=first row")
    check(found.trials[0], np.round(1000 * MOTION, 3))


def test_no_heading_at_all(write, read):
    found = read(write("a.csv", rows("{},{},{}", TIME, MOTION, LOAD)), "load.column=column 3")
    check(found.trials[0])
    assert any(said.startswith("motion.columns: [column 2]") for said in found.guessed)


def test_a_file_per_trial_and_prose_beside_them(write, read):
    for name in ("run_2", "run_10", "run_1"):
        write(
            f"{name}.csv", "time_s,strain_pct,stress_mpa\n" + rows("{},{},{}", TIME, MOTION, LOAD)
        )
    write("README.md", "about")
    found = read(write("notes.txt", "mounted anew after run 2\n"))
    assert [trial.name for trial in found.trials] == ["run_1", "run_2", "run_10"]
    check(found.trials[2])
    assert found.description.motion.unit == "percent"
    assert {said.partition(":")[0] for said in found.dropped} == {"README.md", "notes.txt"}


def test_several_trials_in_one_long_table(write, read):
    parts = [rows(f"{k},{{}},{{}},{{}}", 100 * k + TIME, k * MOTION, LOAD) for k in (1, 2, 3)]
    found = read(write("a.csv", "trial,time [s],deflection [mm],load [N]\n" + "".join(parts)))
    assert [trial.name for trial in found.trials] == ["trial 1", "trial 2", "trial 3"]
    check(found.trials[1], 2 * MOTION)
    assert found.description.clock.start == "first row"


def test_a_clock_that_starts_anew(write, read):
    parts = [rows("{},{},{}", TIME, k * MOTION, LOAD) for k in (1, 2)]
    found = read(write("a.csv", "Time,Extension,Force\n" + "".join(parts)))
    assert found.description.trials.by == "clock"
    check(found.trials[1], 2 * MOTION)


def test_blocks_under_repeated_headings(write, read):
    block = "Specimen {}\nTime;Strain;Stress\ns;%;MPa\n"
    data = rows("{};{};{}", TIME, MOTION, LOAD)
    found = read(write("a.txt", block.format("A7") + data + "\n" + block.format("B2") + data))
    assert [trial.name for trial in found.trials] == ["Specimen A7", "Specimen B2"]
    check(found.trials[0])
    check(found.trials[1])


def test_trials_side_by_side_each_with_a_clock(write, read):
    head = "t_1 (s),strain_1,stress_1 (MPa),t_2 (s),strain_2,stress_2 (MPa)\n"
    data = rows("{},{},{},{},{},{}", TIME, MOTION, LOAD, TIME, 2 * MOTION, LOAD)
    found = read(write("a.csv", head + data))
    assert len(found.trials) == 2
    check(found.trials[1], 2 * MOTION)


def test_deeplabcut(write, read):
    points = ("base", "mid", "tip")
    head = "scorer" + ",net" * 9 + "\nbodyparts" + "".join(f",{p}" * 3 for p in points)
    head += "\ncoords" + ",x,y,likelihood" * 3 + "\n"
    data = "".join(
        f"{k},1,100,1,50,{100 - k},0.99,100,{100 - 2 * k},{0.1 if k == 4 else 0.9}\n"
        for k in range(12)
    )
    found = read(write("videoDLC_resnet50.csv", head + data), "clock.frames_per_second=2")
    (trial,) = found.trials
    assert trial.points == points
    np.testing.assert_allclose(trial.time, TIME)
    np.testing.assert_allclose(trial.motion[2], [1, 100, 50, 98, 100, 96])
    assert np.isnan(trial.motion[4, 4:]).all()
    with pytest.raises(Exception, match="--fps 30"):
        read(write("videoDLC_resnet50.csv", head + data))


def test_sleap_table(write, read):
    head = "track,frame_idx,instance.score"
    head += "".join(f",{p}.x,{p}.y,{p}.score" for p in ("base", "mid", "tip")) + "\n"
    data = "".join(f",{k},1,0,100,1,50,{100 - k},1,100,{100 - 2 * k},1\n" for k in range(12))
    (trial,) = read(write("a.csv", head + data), "clock.frames_per_second=2").trials
    assert trial.points == ("base", "mid", "tip")
    np.testing.assert_allclose(trial.motion[3], [0, 100, 50, 97, 100, 94])


def test_sleap_analysis_file(write, read):
    folder = write("x.md", "")
    tracks = np.full((1, 2, 3, 12), np.nan)  # track, axis, node, frame
    tracks[0, 0], tracks[0, 1] = (
        np.array([[0.0], [50], [100]]),
        100 - np.outer([0, 1, 2], range(12)),
    )
    with h5py.File(folder / "a.analysis.h5", "w") as file:
        file["tracks"], file["node_names"] = tracks, [b"base", b"mid", b"tip"]
        file["track_names"] = [b"finger"]
    (trial,) = read(folder, "clock.frames_per_second=2").trials
    np.testing.assert_allclose(trial.motion[3], [0, 100, 50, 97, 100, 94])
    np.testing.assert_allclose(trial.time, TIME)


def test_movement_dataset(write, read):
    folder = write("x.md", "")
    place = np.zeros((12, 2, 3, 1))
    place[:, 0, :, 0], place[:, 1, :, 0] = [0.0, 50, 100], 100 - np.outer(range(12), [0, 1, 2])
    xr.Dataset(
        {"position": (("time", "space", "keypoints", "individuals"), place)},
        coords={"time": TIME, "space": ["x", "y"], "keypoints": ["base", "mid", "tip"],
                "individuals": ["one"]},
        attrs={"fps": 2.0, "time_unit": "seconds", "ds_type": "poses"},
    ).to_netcdf(folder / "a.nc", engine="h5netcdf")  # fmt: skip
    (trial,) = read(folder).trials
    assert trial.points == ("base", "mid", "tip")
    np.testing.assert_allclose(trial.motion[3], [0, 100, 50, 97, 100, 94])
    np.testing.assert_allclose(trial.time, TIME)


def test_tags_one_a_row(write, read):
    data = "".join(
        f"{t},{tag},{x},{100 - tag * k}\n"
        for k, t in enumerate(TIME) for tag, x in ((7, 0), (8, 50), (12, 100)) if (k, tag) != (5, 8)
    )  # fmt: skip
    (trial,) = read(write("a.csv", "timestamp,tag_id,center_x,center_y\n" + data)).trials
    assert trial.points == ("7", "8", "12")
    np.testing.assert_allclose(trial.motion[3], [0, 79, 50, 76, 100, 64])
    assert np.isnan(trial.motion[5, 2:4]).all()


def test_aruco_corners(write, read):
    corners = ((-2, -2), (2, -2), (2, 2), (-2, 2))
    data = "".join(
        ",".join(map(str, [t, m, *(v for dx, dy in corners for v in (x + dx, 100 - m * k + dy))]))
        + "\n" for k, t in enumerate(TIME) for m, x in ((1, 0), (2, 50), (3, 100))
    )  # fmt: skip
    head = "time,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n"
    (trial,) = read(write("a.csv", head + data)).trials
    assert len(trial.points) == 3
    np.testing.assert_allclose(trial.motion[3], [0, 97, 50, 94, 100, 91])


def test_topics_of_one_recording(write, read):
    stamp = 1_700_000_000_000_000_000
    angle = rows("{},{}", (stamp + TIME * 1e9).astype(np.int64), 0.1 * MOTION)
    force = rows("{},{}", (stamp + (TIME + 0.1) * 1e9).astype(np.int64), LOAD)
    write("bend_angle.csv", "%time,field.data\n" + angle)
    found = read(write("tendon_tension.csv", "%time,field.data\n" + force))
    (trial,) = found.trials
    np.testing.assert_allclose(trial.time, TIME, atol=1e-6)
    np.testing.assert_allclose(trial.motion[:, 0], 0.1 * MOTION)
    np.testing.assert_allclose(trial.load_time, TIME + 0.1, atol=1e-6)
    assert trial.started_at.year == 2023


def test_topics_in_a_folder_per_trial(write, read):
    for name in ("t1", "t2"):
        write(
            f"{name}/joint.csv",
            "secs,nsecs,theta\n"
            + rows("{},{},{}", TIME // 1 + 1.7e9, TIME % 1 * 1e9, 0.1 * MOTION),
        )
        folder = write(f"{name}/loadcell.csv", "time,force\n" + rows("{},{}", TIME + 1.7e9, LOAD))
    found = read(folder)
    assert [trial.name for trial in found.trials] == ["t1", "t2"]
    check(found.trials[1], 0.1 * MOTION)


def test_signals_below_each_other(write, read):
    data = rows("{0},Force,{1},N\n{0},Extension,{2},mm", TIME, LOAD, MOTION)
    found = read(write("a.csv", "time,signal,value,unit\n" + data))
    check(found.trials[0])
    assert (found.description.motion.unit, found.description.load.unit) == ("mm", "N")


def test_signals_below_each_other_with_units_in_their_names(write, read):
    data = rows("{0},force_N,{1}\n{0},angle_deg,{2}", TIME, LOAD, MOTION)
    found = read(write("a.csv", "time,sensor,value\n" + data))
    check(found.trials[0], np.deg2rad(MOTION))  # below 2π, so that its size shows no degrees
    assert (found.description.motion.unit, found.description.load.unit) == ("deg", "N")


def test_workbook_with_dates_hidden_and_other_sheets(write_book, read):
    start = dt.datetime(2026, 3, 1, 10, 0, 0)
    table = [["Sample: A", "", ""], ["Date", "Displacement [mm]", "Load [N]"]]
    table += [
        [start + dt.timedelta(seconds=t), m, f] for t, m, f in zip(TIME, MOTION, LOAD, strict=True)
    ]
    source = write_book(
        "a.xlsx", {"one": table, "two": table, "old": table, "notes": [["hello"]]}, hidden=["old"]
    )
    found = read(source)
    assert [trial.name for trial in found.trials] == ["one", "two"]
    np.testing.assert_allclose(found.trials[0].time, TIME, atol=2e-3)
    np.testing.assert_allclose(found.trials[0].motion[:, 0], MOTION)
    assert found.trials[0].started_at == start.replace(tzinfo=dt.UTC)
    said = " ".join(found.dropped)
    assert "sheet 'old': it is hidden" in said
    assert "sheet 'notes': it contains no table" in said
    assert len(read(source, "tables.hidden_sheets=true").trials) == 3


def test_workbook_with_merged_headings_and_numbers_as_text(write_book, read):
    table = [["left", "", "", "right", "", ""], ["t [s]", "x [mm]", "F [N]"] * 2]
    table += [[comma(t), comma(m), comma(f), comma(t), comma(2 * m), comma(f)]
              for t, m, f in zip(TIME, MOTION, LOAD, strict=True)]  # fmt: skip
    found = read(write_book("a.xlsx", {"s": table}, merged=["A1:C1", "D1:F1"]))
    assert [trial.name for trial in found.trials] == ["left", "right"]
    check(found.trials[1], 2 * MOTION)


def test_units_in_cells_and_different_units_in_files(write, read):
    data = rows("{},{} mm,{} N", TIME[:6], MOTION[:6], LOAD[:6])
    data += rows("{},{} cm,{} N", TIME[6:], MOTION[6:] / 10, LOAD[6:])
    found = read(write("a.csv", "time,travel,force\n" + data))
    check(found.trials[0])
    write("a.csv", "time (s),travel (mm),force (N)\n" + rows("{},{},{}", TIME, MOTION, LOAD))
    found = read(
        write(
            "b.csv",
            "time (min),travel (m),force (N)\n" + rows("{},{},{}", TIME / 60, MOTION / 1000, LOAD),
        )
    )
    check(found.trials[0])
    check(found.trials[1])


def test_a_motion_against_the_load_is_turned(write, read):
    found = read(write("a.csv", "time,angle,pwm\n" + rows("{},{},{}", TIME, -0.1 * MOTION, LOAD)))
    check(found.trials[0], 0.1 * MOTION)
    assert any(said.startswith("motion.sign: -1") for said in found.guessed)


def test_times_of_day_that_pass_midnight(write, read):
    start = dt.datetime(2026, 3, 1, 23, 59, 58)
    clock = [f"{start + dt.timedelta(seconds=t):%H:%M:%S.%f}" for t in TIME]
    found = read(write("a.csv", "Uhrzeit;Weg [mm]\n" + rows("{};{}", clock, MOTION)))
    check(found.trials[0], load=None)


def test_a_rheometer_with_blank_row_between_names_and_units(write, read):
    head = "Project:\tA\nInterval and data points:\t1\t12\n"
    head += "Interval data:\tPoint No.\tTime\tShear Strain\tShear Stress\n\t\t\t\t\n"
    head += "\t\t[s]\t[%]\t[Pa]\n"
    data = rows("\t{}\t{}\t{}\t{}", range(12), TIME, MOTION, LOAD)
    found = read(write("a.csv", (head + data).encode("utf-16")))
    check(found.trials[0])
    assert (found.description.motion.unit, found.description.load.unit) == ("%", "Pa")


def test_labview_header(write, read):
    head = "LabVIEW Measurement\t\nSeparator\tTab\nDate\t2020/01/02\n***End_of_Header***\t\n"
    head += "X_Value\tForce\tDisplacement\tComment\n"
    found = read(write("a.lvm", head + rows("{}\t{}\t{}", TIME, LOAD, MOTION)))
    check(found.trials[0])


def test_words_and_means_below_the_table_are_dropped(write, read):
    data = rows("{},{},{}", TIME, MOTION, LOAD) + "\nMean,1.2,\nEnd of test\n"
    found = read(write("a.csv", "time,strain,stress\n" + data))
    check(found.trials[0])
    assert any("2 rows of words below row 13" in said for said in found.dropped)


def test_a_column_per_load(write, read):
    data = rows("{},{},{}", TIME, MOTION, 2 * MOTION)
    found = read(write("a.csv", "Time (s),5 N,10 N\n" + data))
    assert [trial.name for trial in found.trials] == ["5 N", "10 N"]
    np.testing.assert_allclose(found.trials[1].motion[:, 0], 2 * MOTION)
    assert [trial.load.tolist() for trial in found.trials] == [[5.0], [10.0]]
    assert found.description.load.unit == "N"


def test_trials_side_by_side_on_one_clock_with_a_number_in_every_heading(write, read):
    data = rows("{},{},{},{},{}", TIME, MOTION, 1.1 * MOTION, 0.9 * MOTION, LOAD)
    head = "Time (s),Trial 1 angle (deg),Trial 2 angle (deg),Trial 3 angle (deg),Command\n"
    found = read(write("a.csv", head + data))
    assert [trial.name for trial in found.trials] == ["Trial 1", "Trial 2", "Trial 3"]
    check(found.trials[1], np.deg2rad(1.1 * MOTION))
    head = "time_s,angle_run1_deg,force_run1_n,angle_run2_deg,force_run2_n\n"
    data = rows("{},{},{},{},{}", TIME, MOTION, LOAD, 1.1 * MOTION, 2 * LOAD)
    found = read(write("a.csv", head + data))
    assert [trial.name for trial in found.trials] == ["run 1", "run 2"]
    check(found.trials[1], np.deg2rad(1.1 * MOTION), 2 * LOAD)


def test_joints_with_numbers_are_one_trial(write, read):
    head = "time,joint 1 angle,joint 2 angle,joint 3 angle,load\n"
    data = rows("{},{},{},{},{}", TIME, 0.1 * MOTION, 0.2 * MOTION, 0.3 * MOTION, LOAD)
    found = read(write("a.csv", head + data))
    assert [trial.motion.shape[1] for trial in found.trials] == [3]


def test_a_number_that_stands_for_a_gap_is_one(write, read, write_book):
    seen = [-999 if k in (3, 4) else 0.1 * value for k, value in enumerate(MOTION)]
    true = np.where(np.isin(np.arange(TIME.size), (3, 4)), np.nan, 0.1 * MOTION)
    found = read(write("a.csv", "time,angle,load\n" + rows("{},{},{}", TIME, seen, LOAD)))
    assert found.description.motion.unit == "rad"
    check(found.trials[0], true)
    assert any("-999, in 2 rows, is read as a gap" in said for said in found.dropped)
    table = [["time", "angle", "load"], *map(list, zip(TIME, seen, LOAD, strict=True))]
    check(read(write_book("b.xlsx", {"one": table}) / "b.xlsx").trials[0], true)
    odd = [-7 if value == -999 else value for value in seen]
    table = [["time", "angle", "load"], *map(list, zip(TIME, odd, LOAD, strict=True))]
    book = write_book("c.xlsx", {"one": table}) / "c.xlsx"
    check(read(book, "tables.missing=['-7']", "motion.unit=rad").trials[0], true)


@pytest.mark.parametrize("mark", ["'", "\N{NO-BREAK SPACE}", "\N{NARROW NO-BREAK SPACE}"])
def test_marks_between_thousands(write, read, mark):
    big = [f"{1000 * m + 5000:,.1f}".replace(",", mark) for m in MOTION]
    text = "Zeit [s];Weg [um];Kraft [N]\n" + rows("{};{};{}", TIME, big, LOAD)
    found = read(write("a.csv", text), "motion.start=first row")
    check(found.trials[0], np.round(1000 * MOTION, 1))
