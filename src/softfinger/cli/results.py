"""Verbs from joint angles to the report."""

from __future__ import annotations

from typing import Annotated

import typer

from softfinger.campaign import read_campaign
from softfinger.cli.application import (
    CampaignFolder,
    ConfigFile,
    Out,
    PhysicsFile,
    app,
    choose_model,
    open_inputs,
)
from softfinger.config import read_config
from softfinger.faults import Fault

FITTED = ["angles", "least_squares", "posterior"]


@app.command()
def fit(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Fit every trial by least squares and sample the hierarchical posterior (after `angles`)."""
    from softfinger.stages.fit import fit
    from softfinger.stages.least_squares import least_squares

    inputs = open_inputs(campaign, out, config, ["angles"], "estimation")
    least_squares(least_squares=out / "least_squares.nc", **inputs)
    physics = choose_model(read_config(config), model)
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

    inputs = open_inputs(campaign, out, config, FITTED, "propagation")
    physics = choose_model(read_config(config), model)
    propagate(bands=out / "bands.nc", densities=out / "densities.nc", model=physics, **inputs)


@app.command()
def sobol(
    campaign: CampaignFolder, out: Out, config: ConfigFile = None, model: PhysicsFile = None
) -> None:
    """Split the spread of the joint angles among the parameters (after `fit`)."""
    from softfinger.stages.shapley import shapley
    from softfinger.stages.sobol import sobol

    inputs = open_inputs(campaign, out, config, FITTED, "propagation")
    physics = choose_model(read_config(config), model)
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
        model=choose_model(settings, model),
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
