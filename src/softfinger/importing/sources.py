"""Every table of a file or a folder."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from softfinger.importing.dates import join_date
from softfinger.importing.description import Tables
from softfinger.importing.faults import ImportFault, ImportFaults
from softfinger.importing.quaternions import turn_quaternions
from softfinger.importing.reshape import widen
from softfinger.importing.sheet import split_tables
from softfinger.importing.table import RawTable
from softfinger.importing.text import read_sheet
from softfinger.importing.tracking_files import READERS, read_points
from softfinger.importing.workbook import read_sheets

TABLES = (".csv", ".tsv", ".txt", ".dat", ".asc", ".tab", ".prn", ".log", ".out", ".data")
MACHINES = (".lvm", ".tra", ".raw", ".rpt", ".exp", ".res")
TEXT = frozenset([*TABLES, *MACHINES])
BOOKS = frozenset([".xlsx", ".xls", ".xlsm", ".xlsb", ".ods"])
PROSE = frozenset(["readme", "license", "licence", "source", "changelog", "notes"])


def read_tables(source: Path, asked: Tables) -> tuple[list[RawTable], list[str]]:
    """Read every table below a source.

    Parameters
    ----------
    asked : Tables
        Which files and sheets, and how.

    Returns
    -------
    tables : list of RawTable
        In the order of their paths; long tables are made wide.
    dropped : list of str
        Sentences on files and sheets that contain no table.

    Raises
    ------
    ImportFault, ImportFaults
        The source does not exist, a file cannot be read as asked, or there is no table at all.
    """
    if not source.exists():
        raise ImportFault(f"{source}: it does not exist; name a file or a folder with recordings")
    tables, dropped, faults = [], [], []
    for path, name in _list_files(source, asked, dropped):
        try:
            found, more = _read_file(path, name, asked)
        except ImportFault as fault:
            faults.append(str(fault))
            continue
        read = (replace(table, decimal=asked.decimal or table.decimal) for table in found)
        tables += [turn_quaternions(join_date(widen(table))) for table in read]
        dropped += more
    if faults:
        raise ImportFaults(str(source), faults)
    if not tables:
        listed = "; ".join(dropped[:5]) or "it is empty"
        raise ImportFault(f"{source}: it contains no table of numbers ({listed})")
    dropped += [f"{table.place}: {said}" for table in tables for said in table.dropped]
    return tables, dropped


def _list_files(source: Path, asked: Tables, dropped: list[str]) -> Iterator[tuple[Path, Path]]:
    """Files to read, and names; notes of others."""
    if source.is_file():
        yield source, Path(source.name)
        return
    paths = sorted((p for p in source.rglob("*") if p.is_file()), key=_sort_key)
    for path in paths:
        name = path.relative_to(source)
        suffix = path.suffix.lower()
        if asked.files is not None:
            if any(name.match(pattern) for pattern in asked.files):
                yield path, name
            continue
        if any(part.startswith((".", "~$")) for part in name.parts):
            continue
        prose = path.stem.lower() in PROSE
        if (suffix in TEXT and not prose) or suffix in BOOKS or suffix in READERS:
            yield path, name
        else:
            why = "its ending is of no table; if it is text, type tables: {files: [NAME]}"
            dropped.append(f"{name}: {why}")


def _sort_key(path: Path) -> list[tuple[int, int | str]]:
    """Sort key that puts run 2 before run 10."""
    parts = re.split(r"(\d+)", str(path).lower())
    return [(0, int(part)) if part.isdigit() else (1, part) for part in parts if part]


def _read_file(path: Path, name: Path, asked: Tables) -> tuple[list[RawTable], list[str]]:
    suffix = path.suffix.lower()
    if suffix in READERS:
        return read_points(path, name), []
    if suffix in BOOKS:
        sheets, dropped = read_sheets(path, name, hidden=asked.hidden_sheets)
        if asked.sheets is not None:
            unknown = set(asked.sheets) - {sheet.name for sheet in sheets}
            if unknown:
                raise ImportFault(
                    f"{name}: there is no sheet '{sorted(unknown)[0]}'; it has "
                    f"{', '.join(sheet.name for sheet in sheets)}"
                )
            sheets = [sheet for sheet in sheets if sheet.name in asked.sheets]
    else:
        sheets, dropped = [read_sheet(path, name, asked.delimiter, asked.encoding)], []
    tables = []
    for sheet in sheets:
        found = split_tables(sheet, asked.headings, asked.missing)
        tables += found
        if not found:
            place = f"{name}, sheet '{sheet.name}'" if sheet.name else str(name)
            dropped.append(f"{place}: it contains no table of numbers")
    return tables, dropped
