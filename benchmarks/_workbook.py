"""A workbook (.xlsx), written without a library."""

from __future__ import annotations

import datetime as dt
import zipfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"


def write_book(
    path: Path,
    sheets: Mapping[str, Sequence[Sequence[object]]],
    hidden: Collection[str] = (),
    merged: Collection[str] = (),
) -> None:
    """Write a workbook.

    Parameters
    ----------
    sheets
        Sheet's name → rows.
    hidden
        Names of hidden sheets.
    merged
        Ranges of cells that are merged in each sheet.
    """
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    state = {True: ' state="hidden"', False: ""}
    listed = "".join(
        f'<sheet name="{n}" sheetId="{k}"{state[n in hidden]} r:id="rId{k}"/>'
        for k, n in enumerate(sheets, 1)
    )
    links = "".join(
        f'<Relationship Id="rId{k}" Type="{office}/worksheet" Target="worksheets/s{k}.xml"/>'
        for k in range(1, len(sheets) + 1)
    )
    links += f'<Relationship Id="rId99" Type="{office}/styles" Target="styles.xml"/>'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"/>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r" '
        f'Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{office}"><sheets>{listed}'
        "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">{links}'
        "</Relationships>",
        "xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><cellXfs count="2"><xf numFmtId="0"/>'
        '<xf numFmtId="22" applyNumberFormat="1"/></cellXfs></styleSheet>',
    }
    for k, rows in enumerate(sheets.values(), 1):
        parts[f"xl/worksheets/s{k}.xml"] = _sheet(rows, merged)
    with zipfile.ZipFile(path, "w") as book:
        for part, content in parts.items():
            book.writestr(part, '<?xml version="1.0" encoding="UTF-8"?>' + content)


def _cell(name: str, value: object) -> str:
    if value is None or value == "":
        return ""
    if isinstance(value, dt.datetime):
        days = (value - dt.datetime(1899, 12, 30)) / dt.timedelta(days=1)
        return f'<c r="{name}" s="1"><v>{days!r}</v></c>'
    if isinstance(value, str):
        return f'<c r="{name}" t="inlineStr"><is><t>{value}</t></is></c>'
    return f'<c r="{name}"><v>{float(value)!r}</v></c>'


def _sheet(rows: Sequence[Sequence[object]], merged: Collection[str]) -> str:
    letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    body = "".join(
        f'<row r="{r}">'
        + "".join(_cell(f"{letters[c]}{r}", v) for c, v in enumerate(row))
        + "</row>"
        for r, row in enumerate(rows, 1)
    )
    more = "".join(f'<mergeCell ref="{ref}"/>' for ref in merged)
    more = f"<mergeCells>{more}</mergeCells>" if more else ""
    return f'<worksheet xmlns="{MAIN}"><sheetData>{body}</sheetData>{more}</worksheet>'
