"""What cannot be read is refused with the sheet, the row, the column, and what to type instead."""

import zipfile

import h5py
import numpy as np
import pandas as pd
import pytest

from softfinger.faults import Fault
from softfinger.gate import cells as gate_cells
from softfinger.importing import cells, read_import_description

TABLE = "time (s),angle (deg),force (N)\n" + "".join(f"{t},{t * t},{t}\n" for t in range(12))


def refuse(read, source, *keys):
    with pytest.raises(Fault) as caught:
        read(source, *keys)
    return str(caught.value)


def test_text_in_numbers_names_row_and_column_and_the_way_out(write, read):
    source = write("a.csv", TABLE.replace("6,36,6", "6,torn,6"))
    said = refuse(read, source)
    assert "a.csv, row 8, column 'angle': is 'torn'; expected a number in deg" in said
    assert "tables: {missing: ['torn']}" in said
    (trial,) = read(source, "tables.missing=[torn]").trials
    assert str(trial.motion[6, 0]) == "nan"


def test_text_in_a_workbook_names_the_sheet(write_book, read):
    table = [["t [s]", "x [mm]", "F [N]"], *([t, t * t, 1.0] for t in range(12))]
    table[5][1] = "slipped"
    said = refuse(read, write_book("a.xlsx", {"first": table}))
    assert "a.xlsx, sheet 'first', row 6, column 'x': is 'slipped'; expected a number in mm" in said


def test_a_row_with_too_many_fields(write, read):
    said = refuse(read, write("a.csv", TABLE + "12,1,2,3,4\n13,2,3\n"))
    assert "a.csv, row 14: has 5 fields; its heading has 3" in said
    said = refuse(read, write("a.csv", TABLE + "12,144,12\n" * 500 + "12,1,2,3,4\n"))
    assert "a.csv, row 514: has 5 fields; expected 3" in said


def test_time_that_runs_backwards(write, read):
    said = refuse(read, write("a.csv", TABLE.replace("6,36,6", "4.5,36,6")))
    assert "row 8: time runs backwards in trial a" in said
    assert "trials: {by: clock}" in said


def test_nothing_to_read(write, read, tmp_path):
    assert "it does not exist" in refuse(read, tmp_path / "nowhere")
    assert "the file is empty" in refuse(read, write("a.csv", ""))
    (tmp_path / "source/a.csv").unlink()
    assert "it contains no table of numbers" in refuse(read, write("about.txt", "only words\n"))


def test_a_broken_workbook_and_a_foreign_hdf5_file(write, read, tmp_path):
    said = refuse(read, write("a.xlsx", b"PK broken"))
    assert "a.xlsx: it cannot be read as a workbook" in said
    (tmp_path / "source/a.xlsx").unlink()
    assert "it is not an HDF5 file" in refuse(read, write("a.h5", b"no"))


def test_a_binary_file(write, read):
    assert "it is not text" in refuse(read, write("a.dat", b"\0\1\2\0" * 100))


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("clock.col=t", "clock.col: this key is unknown"),
        ("clock.column=tim", "there is no column 'tim'"),
        ("motion.columns=[angel]", "no column 'angel'; there are time, angle, force"),
        ("motion.unit=furlongz", "unit 'furlongz' is not known"),
        ("trials.by=column", "type trials: {column: …} too"),
        ("load.stated=Load", "'Load' is not stated"),
        ("tables.sheets=3", "tables.sheets"),
        ("clock", "expected key=value"),
    ],
)
def test_a_wrong_description(write, read, key, said):
    assert said in refuse(read, write("a.csv", TABLE), key)


def test_no_motion(write, read):
    said = refuse(read, write("a.csv", "time,force\n" + "".join(f"{t},{t}\n" for t in range(9))))
    assert "no column looks like a motion; there are time, force" in said


def test_a_damaged_sheet_is_refused(tmp_path, read, write_book):
    folder = write_book("a.xlsx", {"first": [["t", "x"], [0, 1], [1, 2]]})
    path = folder / "a.xlsx"
    content = bytearray(path.read_bytes())
    content[content.index(b"<sheetData>") + 3] ^= 4
    path.write_bytes(bytes(content))
    assert "a.xlsx: it cannot be read as a workbook" in refuse(read, folder)


def test_a_description_passes_the_gate(tmp_path):
    path = tmp_path / "import.yaml"
    path.write_text("a: &a [1]\nb: *a\n")
    with pytest.raises(Fault, match="line 2: it contains a YAML alias"):
        read_import_description(path)
    path.write_bytes(b"name: \xff\n")
    with pytest.raises(Fault, match="is not UTF-8 text"):
        read_import_description(path)
    with pytest.raises(Fault, match="--set name=!!int x, line 1: it contains the YAML tag"):
        read_import_description(None, ["name=!!int x"])


def test_a_number_with_two_points_and_a_unit_is_no_number(write, read):
    assert refuse(read, write("a.csv", "x\t3.0. mm\t1\n" * 5))


def test_a_word_that_is_repeated_is_looked_at_once(monkeypatch):
    asked = []

    def read(text, unit, decimal):
        asked.append(text)
        return with_unit(text, unit, decimal)

    with_unit = cells._read_with_unit
    monkeypatch.setattr(cells, "_read_with_unit", read)
    column = pd.Series(["1", "12 mm", "slip", "12 mm", "2", "slip", "slip", "-"])
    values, wrong = cells.read_numbers(column, "m", ".")
    np.testing.assert_allclose(values, [1, 0.012, np.nan, 0.012, 2, np.nan, np.nan, np.nan])
    assert wrong.tolist() == [k in (2, 5, 6) for k in range(8)]
    assert sorted(asked) == ["12 mm", "slip"]


def test_trials_by_a_clock_need_a_clock(write, read):
    table = "angle (deg),force (N)\n" + "3.0,1.0\n2.0,1.5\n" * 6
    said = refuse(read, write("a.csv", table), "trials.by=clock")
    assert "a.csv: no column is a clock" in said
    assert "type clock: {column: …}" in said


def add_to_sheet(path, row):
    """Append a row of XML to a workbook's first sheet."""
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name) for name in book.namelist()}
    sheet = "xl/worksheets/s1.xml"
    parts[sheet] = parts[sheet].replace(b"</sheetData>", row + b"</sheetData>")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        for name, content in parts.items():
            book.writestr(name, content)


@pytest.mark.parametrize("rows", [[["t", "x"], [0, 1], [1, 2]], []])
def test_a_cell_far_from_the_others_is_refused(rows, read, write_book):
    folder = write_book("a.xlsx", {"first": rows})
    far = b'<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>'
    add_to_sheet(folder / "a.xlsx", far)
    said = refuse(read, folder)
    assert "a.xlsx: " in said
    assert "cells far from the others" in said


def test_a_million_rows_of_a_dozen_columns_are_no_reason_to_refuse(monkeypatch):
    class Sheet:
        name, total_height, total_width, merged_cell_ranges = "first", 1_048_576, 12, None

        def to_python(self, skip_empty_area):
            return [["t", 1.0]]

    monkeypatch.setattr(gate_cells.resource, "getrlimit", lambda kind: (4 << 30, 4 << 30))
    assert gate_cells._read_sheet(Sheet()) == ([["t", 1.0]], 0)
    monkeypatch.setattr(gate_cells.resource, "getrlimit", lambda kind: (1 << 20, 1 << 20))
    with pytest.raises(Fault, match="'first', of 1048576 rows and 12 columns, which need more"):
        gate_cells._read_sheet(Sheet())


def test_a_workbook_that_unpacks_to_gigabytes_is_refused(read, write_book):
    folder = write_book("a.xlsx", {"first": [["t", "x"], [0, 1], [1, 2]]})
    add_to_sheet(folder / "a.xlsx", b'<row r="4"><c t="str"><v>' + b"x" * 400_000_000)
    with zipfile.ZipFile(folder / "a.xlsx") as book:
        assert sum(i.compress_size for i in book.infolist()) < 1_000_000
    assert "a.xlsx: " in refuse(read, folder)


@pytest.mark.parametrize("shape", [(3,), (1, 2, 2), (1, 2, 2, 10**12)])
def test_an_hdf5_file_of_another_shape_or_of_terabytes_is_refused(tmp_path, read, shape):
    (tmp_path / "source").mkdir()
    with h5py.File(tmp_path / "source/a.h5", "w") as file:
        file.create_dataset("tracks", shape, "f8", chunks=True)
        file["node_names"] = [b"a", b"b"]
    said = refuse(read, tmp_path / "source")
    assert "a.h5: " in said
    assert ("tracks is" in said) == (len(shape) < 4)
