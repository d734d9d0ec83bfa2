"""The command line: one verb per stage, plus `check` and `run`."""

from __future__ import annotations

import os
import subprocess
import sys
from json import dumps
from pathlib import Path
from typing import Annotated, Any

import typer

from softfinger.campaign import check_campaign, list_tables, read_campaign
from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.progress import silence_progress
from softfinger.provenance import PROJECT
from softfinger.rig.cli import app as rig_app

app = typer.Typer(
    help="From rig videos of a wire-driven soft finger to its posterior, its spread and a report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

app.add_typer(rig_app, name="rig")

FITTED = ["angles", "least_squares", "posterior"]

CampaignFolder = Annotated[Path, typer.Argument(help="Campaign folder.", metavar="CAMPAIGN")]
Out = Annotated[Path, typer.Option(help="Folder that holds the artifacts.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, for programs.")]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", help="YAML file whose keys replace the defaults.")
]


@app.callback()
def options(
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress bars.")] = False,
) -> None:
    """From rig videos of a wire-driven soft finger to its posterior, its spread and a report."""
    if quiet:
        silence_progress()


PhysicsFile = Annotated[
    Path | None,
    typer.Option("--model", help="Model file (model.yaml) that replaces the base model."),
]


def main() -> None:
    """Run the command line; a fault of the input is one sentence and exit status 1."""
    try:
        app()
    except Fault as fault:
        print(f"softfinger: {fault}", file=sys.stderr)
        sys.exit(1)


@app.command()
def doctor(out: Out = Path("results"), json: Json = False) -> None:
    """Look whether this installation can work: packages, video, compiler, disk.

    Exit status 0: all is well. 1: something is not; the advice says what to do.
    """
    from softfinger.doctor import check_setup

    findings = list(check_setup(out))
    if json:
        typer.echo(_dump_json([finding._asdict() for finding in findings]))
    else:
        for what, well, said, advice in findings:
            typer.echo(f"{'ok  ' if well else 'BAD '} {what}: {said}")
            if not well:
                typer.echo(f"     {advice}")
    raise typer.Exit(code=0 if all(finding.well for finding in findings) else 1)


@app.command()
def check(campaign: CampaignFolder, json: Json = False) -> None:
    """Validate a campaign folder and list every fault; nothing is written.

    Exit status 0: every trial can be used. 1: some are set aside, or the campaign is refused.
    """
    reasons = check_campaign(campaign)
    described = read_campaign(campaign)
    if json:
        names = [trial.name for trial in described.trials if trial.name not in reasons]
        typer.echo(_dump_json({"name": described.name, "usable": names, "set_aside": reasons}))
        raise typer.Exit(code=1 if reasons else 0)
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
    model: PhysicsFile = None,
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
    from softfinger.virtual_rig.population import build_trial_names

    settings = read_config(config)
    knobs, seed = settings["virtual_rig"], settings["seed"]
    folder, truth = out / "campaign", out / "truth.nc"
    physics = _choose_model(settings, model)
    virtual_rig(truth=truth, folder=folder, config=knobs, seed=seed, model=physics)
    if knobs["level"] == "video":
        names = build_trial_names(knobs["n_trials"])
        videos = [folder / f"video/{name}.avi" for name in names]
        film(truth=truth, videos=videos, config=knobs, seed=seed)


@app.command()
def track(
    campaign: CampaignFolder,
    out: Out,
    config: ConfigFile = None,
    overlays: Annotated[
        bool, typer.Option("--overlays", help="Write OUT/overlays: what was found, in the videos.")
    ] = False,
) -> None:
    """Follow the markers through every video: OUT/markers/*.nc, and how well it went."""
    from softfinger.stages.picture import picture
    from softfinger.stages.track import track
    from softfinger.stages.tracking_quality import tracking_quality

    settings, described = read_config(config), read_campaign(campaign)
    size, tables = settings["trials_per_job"], list_tables(described)
    filmed = [trial for trial in described.trials if trial.level == "video"]
    if not filmed:
        raise Fault(f"{campaign}: no trial has a video, so there is nothing to track")
    batches = [filmed[first : first + size] for first in range(0, len(filmed), size)]
    files = [out / f"markers/{batch:04d}.nc" for batch in range(len(batches))]
    shared = {"folder": campaign, "tables": tables, "seed": settings["seed"]}
    for trials, markers in zip(batches, files, strict=True):
        names, videos = [trial.name for trial in trials], [trial.recording for trial in trials]
        track(trials=names, videos=videos, markers=markers, **shared)
        if overlays:
            _write_overlays(campaign, out, dict(zip(names, videos, strict=True)), markers)
    videos = [trial.recording for trial in batches[0]]
    picture(videos=videos, markers=files[0], picture=out / "picture.nc", **shared)
    quality = out / "tracking_quality.nc"
    tracking_quality(markers=files, tracking_quality=quality, seed=settings["seed"])


@rig_app.command("plan")
def plan_rig(
    plan: Annotated[Path, typer.Argument(help="The rig's plan; docs/rig/plan.yaml is an example.")],
    out: Out,
    tell_apart: Annotated[
        list[str] | None,
        typer.Option(help="Id of an effect that is to show; may be repeated. None: all."),
    ] = None,
    campaign: Annotated[
        Path | None, typer.Option(help="Earlier campaign of the same finger. None: the paper's.")
    ] = None,
    config: ConfigFile = None,
) -> None:
    """Propose profiles that show what you want to tell apart: OUT/plan.yaml, OUT/visibility.nc.

    Exit status 0: there is a proposal. 1: no protocol within the plan's limits would show it.
    """
    from softfinger.stages.prepare import prepare_angles
    from softfinger.stages.rig_plan import rig_plan

    settings = read_config(config)
    found = rig_plan(
        plan=plan,
        wanted=tell_apart or [],
        angles=prepare_angles(campaign, out, settings) if campaign else None,
        visibility=out / "visibility.nc",
        proposal=out / "plan.yaml",
        config=settings["virtual_rig"],
        seed=settings["seed"],
    )
    if found is None:
        typer.echo("no protocol within the plan's limits would show any of them")
        raise typer.Exit(code=1)
    best, table = found
    gains = table["expected_gain"].transpose("effect", "protocol").to_pandas()
    typer.echo("evidence to expect [nats] of an effect of usual strength, in a dozen trials:")
    typer.echo(gains.to_string(na_rep="-", float_format="{:.3g}".format))
    typer.echo(f"proposed: {best}; its profiles stand in {out / 'plan.yaml'}")


def _write_overlays(campaign: Path, out: Path, videos: dict[str, Path], markers: Path) -> None:
    from softfinger.stages.overlay import overlay

    for name, video in videos.items():
        films = {"film": out / f"overlays/{name}.avi", "sheet": out / f"overlays/{name}.jpg"}
        overlay(folder=campaign, trial=name, video=video, markers=markers, **films)


@app.command()
def calibrate(
    pictures: Annotated[Path, typer.Argument(help="Folder of pictures of the board.")],
    columns: Annotated[int, typer.Option(help="Squares side by side.", min=3)],
    rows: Annotated[int, typer.Option(help="Squares on top of each other.", min=3)],
    square_m: Annotated[float, typer.Option(help="Side of a square [m].")],
    marker_m: Annotated[
        float | None, typer.Option(help="Side of the coded markers [m]: a ChArUco board.")
    ] = None,
    dictionary: Annotated[str, typer.Option(help="Of the coded markers.")] = "DICT_4X4_50",
) -> None:
    """Find a camera's intrinsics from pictures of a chessboard or ChArUco board.

    Prints the lines that stand under `camera:` in campaign.yaml.
    """
    from softfinger.tracking.calibration import Board, calibrate_camera

    kind = "chessboard" if marker_m is None else "charuco"
    board = Board(kind, columns, rows, square_m, marker_m, dictionary)
    found = calibrate_camera(sorted(p for p in pictures.iterdir() if p.is_file()), board)
    for name, reason in found.set_aside.items():
        typer.echo(f"set aside {name}: {reason}", err=True)
    sd = " and ".join(f"{value:.2g}" for value in found.focal_sd)
    typer.echo(f"corners deviate {found.rms:.3g} px rms; focal lengths known to {sd} px", err=True)
    typer.echo(found.to_yaml(), nl=False)


@app.command()
def angles(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Gather joint angles and loads of all trials: OUT/angles.nc (after `track`, if filmed)."""
    from softfinger.stages.angles import angles

    settings = read_config(config)
    angles(
        folder=campaign,
        tables=list_tables(read_campaign(campaign)),
        markers=sorted((out / "markers").glob("*.nc")),
        angles=out / "angles.nc",
        config=settings["tracking"],
        seed=settings["seed"],
    )


@app.command()
def fit(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Fit every trial by least squares and sample the hierarchical posterior (after `angles`)."""
    from softfinger.stages.fit import fit
    from softfinger.stages.least_squares import least_squares

    inputs = _open_inputs(campaign, out, config, ["angles"], "estimation")
    least_squares(least_squares=out / "least_squares.nc", **inputs)
    physics = _choose_model(read_config(config), model)
    fit(posterior=out / "posterior.nc", sampling=out / "sampling.nc", model=physics, **inputs)


@app.command()
def recovery(out: Out) -> None:
    """Hold both ways of fitting against the truth of OUT's simulated campaign (after `fit`).

    Writes OUT/recovery.nc and the table OUT/recovery.csv.
    """
    from softfinger.stages.recovery import recovery

    inputs = {name: out / f"{name}.nc" for name in ("truth", "least_squares", "posterior")}
    if not inputs["truth"].exists():
        raise Fault(f"{inputs['truth']} is not there: only a simulated campaign has a known truth")
    seed, table = read_config(None)["seed"], out / "recovery.csv"
    recovery(**inputs, recovery=out / "recovery.nc", table=table, seed=seed)
    typer.echo(table.read_text(encoding="utf-8"), nl=False)


@app.command()
def propagate(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Propagate the spread to bands and densities of the joint angles (after `fit`)."""
    from softfinger.stages.propagate import propagate

    inputs = _open_inputs(campaign, out, config, FITTED, "propagation")
    physics = _choose_model(read_config(config), model)
    propagate(bands=out / "bands.nc", densities=out / "densities.nc", model=physics, **inputs)


@app.command()
def sobol(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Split the spread of the joint angles among the parameters (after `fit`)."""
    from softfinger.stages.shapley import shapley
    from softfinger.stages.sobol import sobol

    inputs = _open_inputs(campaign, out, config, FITTED, "propagation")
    physics = _choose_model(read_config(config), model)
    sobol(sobol=out / "sobol.nc", model=physics, **inputs)
    if physics is None:  # Shapley effects know the base model alone
        inputs.pop("least_squares")
        shapley(shapley=out / "shapley.nc", **inputs)


@app.command()
def assumptions(out: Out, config: ConfigFile = None) -> None:
    """Check what the paper takes for granted, on simulated fingers: OUT/assumptions.nc."""
    from softfinger.artifacts import open_artifact
    from softfinger.artifacts.specs.assumptions import SPEC
    from softfinger.stages.assumptions import assumptions

    settings = read_config(config)
    path = out / "assumptions.nc"
    assumptions(assumptions=path, config=settings["virtual_rig"], seed=settings["seed"])
    for sentence in open_artifact(path, SPEC)["statement"].values:
        typer.echo(str(sentence))


@app.command()
def diagnose(
    campaign: CampaignFolder,
    out: Out,
    config: ConfigFile = None,
    model: PhysicsFile = None,
    mcmc: Annotated[
        bool | None, typer.Option("--mcmc/--no-mcmc", help="Sample the repaired model.")
    ] = None,
) -> None:
    """Find out which physics was left out, from whatever level the campaign has.

    Writes OUT/verdict.json, OUT/model.yaml (the repaired model) and the artifacts behind them.
    Exit status 0: there is a verdict, whatever it says. 1: the campaign is refused.
    """
    from softfinger.mismatch.verdict import read_verdict
    from softfinger.stages.diagnose import SPECS, diagnose
    from softfinger.stages.prepare import prepare_angles

    settings = read_config(config)
    if mcmc is not None:
        settings["mismatch"]["sample_repaired"] = mcmc
    diagnose(
        angles=prepare_angles(campaign, out, settings),
        verdict=out / "verdict.json",
        repaired=out / "model.yaml",
        next_experiment=out / "next_experiment",
        config=settings["mismatch"],
        seed=settings["seed"],
        model=_choose_model(settings, model),
        **{name: out / f"{name}.nc" for name in SPECS},
    )
    verdict = read_verdict(out / "verdict.json")
    typer.echo(f"{verdict.campaign}: {verdict.decision}")
    for effect in verdict.effects:
        typer.echo(effect.statement)
    if verdict.next_experiment:
        typer.echo(verdict.next_experiment["statement"])


@app.command()
def report(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Write OUT/report.html from the artifacts in OUT (after all the other verbs)."""
    from softfinger.stages.report import DIAGNOSED, FILMED, SPECS, report

    read_campaign(campaign)
    made = [name for name in [*FILMED, *DIAGNOSED] if (out / f"{name}.nc").exists()]
    verdict = out / "verdict.json"
    report(
        report=out / "report.html",
        markers=sorted((out / "markers").glob("*.nc")),
        config=read_config(config),
        **({"verdict": verdict} if verdict.exists() else {}),
        **{name: out / f"{name}.nc" for name in [*SPECS, *made]},
    )


def _choose_model(settings: dict[str, Any], given: Path | None) -> Path | None:
    """Model file that was given, else the configuration's, else none."""
    if given is not None or settings["model"] is None:
        return given
    return Path(settings["model"])


def _open_inputs(
    campaign: Path, out: Path, config: Path | None, artifacts: list[str], block: str
) -> dict[str, Any]:
    """Arguments that the stages after `angles` share; the campaign must still be readable."""
    read_campaign(campaign)
    settings = read_config(config)
    files = {name: out / f"{name}.nc" for name in artifacts}
    return files | {"config": settings[block], "seed": settings["seed"]}


def _dump_json(content: object) -> str:
    return dumps(content, indent=2, default=str, ensure_ascii=False)
