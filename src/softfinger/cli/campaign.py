"""Verbs around a whole campaign: `doctor`, `check` and `run`."""

from __future__ import annotations

import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from softfinger.campaign import read_campaign
from softfinger.cli.application import (
    CampaignFolder,
    ConfigFile,
    Json,
    Out,
    app,
    dump_json,
    show_example,
)
from softfinger.cli.supervision import run_to_end
from softfinger.config import read_config
from softfinger.faults import CampaignFault
from softfinger.progress import QUIET
from softfinger.provenance import PROJECT


@app.command(epilog=show_example("softfinger doctor"))
def doctor(
    out: Annotated[Path, typer.Option(help="Folder that would hold results.")] = Path("results"),
    json: Json = False,
) -> None:
    """Check whether this installation works.

    It looks at packages, video, compiler and disk.

    Exit status 0: all is well. 1: something is not; the advice states what to do.
    """
    from softfinger.doctor import check_setup

    findings = list(check_setup(out))
    if json:
        typer.echo(dump_json([finding._asdict() for finding in findings]))
    else:
        for what, well, said, advice in findings:
            typer.echo(f"{'ok  ' if well else 'BAD '} {what}: {said}")
            if not well:
                typer.echo(f"     {advice}")
    raise typer.Exit(code=0 if all(finding.well for finding in findings) else 1)


@app.command(epilog=show_example("softfinger check my_campaign"))
def check(
    campaign: CampaignFolder,
    json: Json = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit status 1 where something looks wrong, too.")
    ] = False,
) -> None:
    """Validate a campaign folder, without writing anything.

    Lists every fault, and what looks wrong.

    Exit status 0: every trial can be used. 1: some are set aside, or the campaign is refused; or
    something looks wrong, and `--strict` was given.
    """
    from softfinger.stages.check import check

    try:
        described, reasons, doubts = check(campaign)
    except CampaignFault as fault:
        if json:
            typer.echo(dump_json({"usable": [], "place": fault.place, "faults": fault.faults}))
            raise typer.Exit(code=1) from None
        raise
    status = 1 if reasons or (strict and doubts) else 0
    if json:
        names = [trial.name for trial in described.trials if trial.name not in reasons]
        said = {"name": described.name, "usable": names, "set_aside": reasons, "faults": []}
        typer.echo(dump_json(said | {"warnings": [asdict(doubt) for doubt in doubts]}))
        raise typer.Exit(code=status)
    for name, reason in reasons.items():
        typer.echo(f"set aside {name}: {reason}")
    for doubt in doubts:
        typer.echo(f"warning ({doubt.id}): {doubt.statement}")
    total = len(described.trials) + len(described.set_aside)
    typer.echo(f"{described.name}: {total - len(reasons)} of {total} trials can be used")
    raise typer.Exit(code=status)


@app.command(epilog=show_example("softfinger run my_campaign --out my_results"))
def run(
    campaign: CampaignFolder,
    out: Out,
    config: ConfigFile = None,
    cores: Annotated[int, typer.Option(help="Processor cores to use.", min=1)] = 2,
    json: Json = False,
) -> None:
    """Run the workflow on a campaign.

    It starts from whatever level the campaign has, and makes its artifacts and report.
    """
    status = run_workflow(campaign, out, config, cores)
    if json:
        names = {"report": "report.html", "verdict": "verdict.json", "logs": "logs"}
        made = {name: out.resolve() / file for name, file in names.items()}
        typer.echo(dump_json({"finished": status == 0} | made))
    raise typer.Exit(code=status)


def run_workflow(campaign: Path, out: Path, config: Path | None, cores: int) -> int:
    """Run the workflow on a campaign; its exit status."""
    read_campaign(campaign)
    read_config(config)
    out.mkdir(parents=True, exist_ok=True)
    files = ["--configfile", str(config.resolve())] if config else []
    settings = [f"campaign={campaign.resolve()}", f"out={out.resolve()}"]
    command = [sys.executable, "-P", "-m", "snakemake"]
    command += ["--snakefile", str(PROJECT / "workflow/Snakefile")]
    command += ["--workflow-profile", str(PROJECT / "profiles/default")]
    command += ["--quiet"] if QUIET in os.environ else []
    command += ["--cores", str(cores), "--directory", str(out)]
    command += ["--nolock"]  # we have our own, which ends with its process
    command += [*files, "--config", *settings]
    return run_to_end(command)
