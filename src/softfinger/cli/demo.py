"""Verb `demo`: a report of the example."""

import contextlib
import filecmp
import io
import multiprocessing
import shutil
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Annotated

import typer

from softfinger.cli.application import Json, app, dump_json, show_example
from softfinger.cli.diagnose import describe_verdict, write_verdict
from softfinger.cli.recordings import angles
from softfinger.cli.results import assumptions, fit, propagate, report, sobol, summarise
from softfinger.cli.supervision import hold_folder
from softfinger.faults import Fault
from softfinger.provenance import PROJECT

EXAMPLE, SETTINGS = PROJECT / "data/example", PROJECT / "config/demo.yaml"


@app.command(epilog=show_example("softfinger demo"))
def demo(
    out: Annotated[
        Path, typer.Option(help="Folder for the example and its results.", callback=hold_folder)
    ] = Path("softfinger-demo"),
    json: Json = False,
) -> None:
    """Make a report of the example, in a minute.

    Copies four short simulated recordings to OUT/campaign, and takes every step from them to
    OUT/report.html, as `run` does. Longer the first time, when code is compiled.
    """
    started, campaign = time.monotonic(), out / "campaign"
    _refuse_another(campaign)
    shutil.copytree(EXAMPLE, campaign, dirs_exist_ok=True)
    with contextlib.redirect_stdout(io.StringIO()):  # what single verbs say; the report has it
        _take_every_step(campaign, out)
    page, seconds = (out / "report.html").resolve(), round(time.monotonic() - started)
    if json:
        typer.echo(dump_json({"report": page, "campaign": campaign.resolve(), "seconds": seconds}))
        return
    for line in describe_verdict(out / "verdict.json"):
        typer.echo(line)
    typer.echo(f"the report is {page} ({seconds} s); open it in a browser")
    typer.echo(f"the recordings are in {campaign}; for your own: softfinger new my_campaign")


def _refuse_another(campaign: Path) -> None:
    """Refuse a folder whose campaign is not the example."""
    there, ours = campaign / "campaign.yaml", EXAMPLE / "campaign.yaml"
    if campaign.exists() and not (there.is_file() and filecmp.cmp(there, ours, shallow=False)):
        raise Fault(f"{campaign}: is there and not the example; choose another folder with --out")


def _take_every_step(campaign: Path, out: Path) -> None:
    """Run all verbs, the diagnosis beside the others."""
    angles(campaign, out, SETTINGS)
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawned) as beside:
        verdict = beside.submit(write_verdict, campaign, out, SETTINGS)
        for verb in (fit, propagate, sobol):
            verb(campaign, out, SETTINGS)
        assumptions(out, SETTINGS)
        verdict.result()
    for verb in (summarise, report):
        verb(campaign, out, SETTINGS)
