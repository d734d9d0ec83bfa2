"""Verbs from joint angles to the report.

`diagnose` is apart.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import typer

from softfinger.campaign import read_campaign
from softfinger.cli.application import (
    STEPS,
    CampaignFolder,
    ConfigFile,
    Json,
    Out,
    PhysicsFile,
    app,
    choose_model,
    dump_json,
    open_inputs,
    refuse_foreign,
    show_example,
)
from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.stages.keys import choose_settings

FITTED = ["angles", "least_squares", "posterior"]


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger fit my_campaign --out my_results")
)
def fit(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Fit every trial, and sample the posterior.

    Each trial by least squares, and the hierarchical posterior of all (after `angles`).
    """
    from softfinger.stages.fit import fit
    from softfinger.stages.least_squares import least_squares
    from softfinger.stages.sampling import sampling

    settings, posterior = read_config(config), out / "posterior.nc"
    physics = choose_model(settings, model)
    inputs = open_inputs(campaign, out, config, ["angles"], "least_squares")
    least_squares(least_squares=out / "least_squares.nc", model=physics, **inputs)
    inputs = open_inputs(campaign, out, config, ["angles"], "fit")
    fit(
        posterior=posterior,
        cores=settings["estimation"]["cores"],
        seed=settings["seed"],
        model=physics,
        **inputs,
    )
    inputs = open_inputs(campaign, out, config, ["posterior"], "sampling")
    sampling(sampling=out / "sampling.nc", **inputs)


@app.command(rich_help_panel=STEPS, epilog=show_example("softfinger recovery --out my_results"))
def recovery(out: Out, json: Json = False) -> None:
    """Compare both fits with a simulated campaign's truth.

    The truth is that of OUT's campaign (after `fit`).

    Writes OUT/recovery.nc and the table OUT/recovery.csv.
    """
    from softfinger.stages.recovery import recovery

    inputs = {name: out / f"{name}.nc" for name in ("truth", "least_squares", "posterior")}
    if not inputs["truth"].exists():
        raise Fault(f"{inputs['truth']} is not there: only a simulated campaign has a known truth")
    table = out / "recovery.csv"
    recovery(**inputs, recovery=out / "recovery.nc", table=table)
    text = table.read_text(encoding="utf-8")
    typer.echo(dump_json(list(csv.DictReader(text.splitlines()))) if json else text, nl=json)


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger propagate my_campaign --out my_results")
)
def propagate(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Propagate the spread to the joint angles.

    As bands and densities (after `fit`).
    """
    from softfinger.stages.propagate import propagate

    inputs = open_inputs(campaign, out, config, FITTED, "propagate")
    settings = read_config(config)
    inputs |= {"model": choose_model(settings, model), "seed": settings["seed"]}
    propagate(bands=out / "bands.nc", densities=out / "densities.nc", **inputs)


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger sobol my_campaign --out my_results")
)
def sobol(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Split the angles' spread among the parameters.

    The spread is that of the joint angles (after `fit`).
    """
    from softfinger.stages.shapley import shapley
    from softfinger.stages.sobol import sobol

    inputs = open_inputs(campaign, out, config, FITTED, "sobol")
    settings = read_config(config)
    own = {"model": choose_model(settings, model), "seed": settings["seed"]}
    sobol(sobol=out / "sobol.nc", **own, **inputs)
    inputs = open_inputs(campaign, out, config, ["angles", "posterior"], "shapley")
    shapley(shapley=out / "shapley.nc", **own, **inputs)


@app.command(rich_help_panel=STEPS, epilog=show_example("softfinger assumptions --out my_results"))
def assumptions(out: Out, config: ConfigFile = None, json: Json = False) -> None:
    """Check what the paper takes for granted.

    On simulated fingers: OUT/assumptions.nc.
    """
    from softfinger.artifacts import open_artifact
    from softfinger.artifacts.specs.assumptions import SPEC
    from softfinger.stages.assumptions import assumptions

    settings = read_config(config)
    path = out / "assumptions.nc"
    knobs = choose_settings(settings, "assumptions")
    assumptions(assumptions=path, config=knobs, seed=settings["seed"])
    sentences = [str(sentence) for sentence in open_artifact(path, SPEC)["statement"].values]
    typer.echo(dump_json({"statements": sentences}) if json else "\n".join(sentences))


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger summarise my_campaign --out my_results")
)
def summarise(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Sum up and check the artifacts in OUT.

    Run it after all the verbs whose results are to be shown.
    """
    from softfinger.stages.summarise import summarise

    settings = read_config(config)
    summarise(
        checks=out / "checks.nc",
        summary=out / "summary.nc",
        config=choose_settings(settings, "summarise"),
        seed=settings["seed"],
        model=choose_model(settings, model),
        **list_made(campaign, out),
    )


@app.command(
    rich_help_panel=STEPS, epilog=show_example("softfinger report my_campaign --out my_results")
)
def report(campaign: CampaignFolder, out: Out, config: ConfigFile = None) -> None:
    """Write OUT/report.html from the artifacts in OUT (after `summarise`)."""
    from softfinger.stages.opening import SUMMED
    from softfinger.stages.report import report

    made = list_made(campaign, out) | {name: out / f"{name}.nc" for name in SUMMED}
    report(report=out / "report.html", config=read_config(config), **made)


def list_made(campaign: Path, out: Path) -> dict[str, Any]:
    """List the artifacts in OUT that a report shows.

    The marker files come with them.
    """
    from softfinger.stages.opening import DIAGNOSED, FILMED, SPECS

    refuse_foreign(read_campaign(campaign), out)
    files = {name: out / f"{name}.nc" for name in [*SPECS, *FILMED, *DIAGNOSED]}
    files["verdict"] = out / "verdict.json"
    needed = {"angles": files["angles"]}
    made = {name: file for name, file in files.items() if file.exists()}
    return {**needed, **made, "markers": sorted((out / "markers").glob("*.nc"))}
