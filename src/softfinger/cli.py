"""The command line: one verb per stage, plus `check` and `run`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import typer

from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.provenance import PROJECT

app = typer.Typer(
    help="From rig videos of a wire-driven soft finger to its posterior, its spread and a report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

CampaignFolder = Annotated[Path, typer.Argument(help="Campaign folder.", metavar="CAMPAIGN")]
Out = Annotated[Path, typer.Option(help="Folder that holds the artifacts.")]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", help="YAML file whose keys replace the defaults.")
]


def main() -> None:
    """Run the command line; a fault of the input is one sentence and exit status 1."""
    try:
        app()
    except Fault as fault:
        print(f"softfinger: {fault}", file=sys.stderr)
        sys.exit(1)


@app.command()
def check(campaign: CampaignFolder) -> None:
    """Validate a campaign folder and list every fault; nothing is written.

    Exit status 0: every trial can be used. 1: some are set aside, or the campaign is refused.
    """
    from softfinger.campaign import check_campaign, read_campaign

    reasons = check_campaign(campaign)
    described = read_campaign(campaign)
    for name, reason in reasons.items():
        typer.echo(f"set aside {name}: {reason}")
    total = len(described.trials) + len(described.set_aside)
    typer.echo(f"{described.name}: {total - len(reasons)} of {total} trials can be used")
    raise typer.Exit(code=1 if reasons else 0)


@app.command()
def run(
    campaign: CampaignFolder,
    out: Out,
    config: ConfigFile = None,
    cores: Annotated[int, typer.Option(help="Processor cores to use.", min=1)] = 2,
) -> None:
    """Take a campaign from whatever level it has to its artifacts and report, by the workflow."""
    from softfinger.campaign import read_campaign

    read_campaign(campaign)
    read_config(config)
    out.mkdir(parents=True, exist_ok=True)
    files = ["--configfile", str(config.resolve())] if config else []
    settings = [f"campaign={campaign.resolve()}", f"out={out.resolve()}"]
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(PROJECT / "Snakefile")]
    command += ["--cores", str(cores), "--directory", str(out), *files, "--config", *settings]
    raise typer.Exit(code=subprocess.call(command, env=os.environ))


@app.command()
def virtual_rig(
    out: Out,
    config: ConfigFile = None,
    example: Annotated[
        bool, typer.Option("--example", help="Write the small example campaign, and nothing else.")
    ] = False,
) -> None:
    """Draw, move and film a finger: writes OUT/campaign, and the truth beside it."""
    if example:
        from softfinger.virtual_rig.example import write_example_campaign

        write_example_campaign(out)
        return
    from softfinger.stages.film import film
    from softfinger.stages.virtual_rig import virtual_rig

    settings = read_config(config)
    knobs, seed = settings["virtual_rig"], settings["seed"]
    folder, truth = out / "campaign", out / "truth.nc"
    virtual_rig(truth=truth, folder=folder, config=knobs, seed=seed)
    if knobs["level"] == "video":
        film(truth=truth, folder=folder, config=knobs, seed=seed)


@app.command()
def track(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Follow the markers through every video: OUT/markers/*.nc."""
    from softfinger.campaign import read_campaign
    from softfinger.stages.track import track

    settings = read_config(config)
    names = [t.name for t in read_campaign(campaign).trials if t.level == "video"]
    size = settings["trials_per_job"]
    for first in range(0, len(names), size):
        track(
            folder=campaign,
            trials=names[first : first + size],
            markers=out / f"markers/{first // size:04d}.nc",
            config=settings["tracking"],
            seed=settings["seed"],
        )


@app.command()
def angles(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Gather joint angles and loads of all trials: OUT/angles.nc (after `track`, if filmed)."""
    from softfinger.stages.angles import angles

    settings = read_config(config)
    angles(
        folder=campaign,
        markers=sorted((out / "markers").glob("*.nc")),
        angles=out / "angles.nc",
        config=settings["tracking"],
        seed=settings["seed"],
    )


@app.command()
def fit(out: Out, config: ConfigFile = None) -> None:
    """Fit every trial by least squares and sample the hierarchical posterior (after `angles`)."""
    from softfinger.stages.fit import fit
    from softfinger.stages.least_squares import least_squares

    settings = read_config(config)
    shared = {
        "angles": out / "angles.nc",
        "config": settings["estimation"],
        "seed": settings["seed"],
    }
    least_squares(least_squares=out / "least_squares.nc", **shared)
    fit(posterior=out / "posterior.nc", sampling=out / "sampling.nc", **shared)


@app.command()
def propagate(out: Out, config: ConfigFile = None) -> None:
    """Propagate the spread to bands and densities of the joint angles (after `fit`)."""
    from softfinger.stages.propagate import propagate

    propagate(
        bands=out / "bands.nc", densities=out / "densities.nc", **_propagation_inputs(out, config)
    )


@app.command()
def sobol(out: Out, config: ConfigFile = None) -> None:
    """Split the spread of the joint angles among the parameters (after `fit`)."""
    from softfinger.stages.sobol import sobol

    sobol(sobol=out / "sobol.nc", **_propagation_inputs(out, config))


@app.command()
def report(out: Out, config: ConfigFile = None) -> None:
    """Write OUT/report.html from the artifacts in OUT."""
    from softfinger.stages.report import ARTIFACTS, report

    report(
        report=out / "report.html",
        config=read_config(config),
        **{name: out / f"{name}.nc" for name in ARTIFACTS},
    )


def _propagation_inputs(out: Path, config: Path | None) -> dict:
    settings = read_config(config)
    artifacts = {name: out / f"{name}.nc" for name in ("angles", "least_squares", "posterior")}
    return artifacts | {"config": settings["propagation"], "seed": settings["seed"]}
