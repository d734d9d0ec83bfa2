"""The verb `diagnose`."""

from __future__ import annotations

from typing import Annotated

import typer

from softfinger.cli.application import (
    CampaignFolder,
    ConfigFile,
    Out,
    PhysicsFile,
    app,
    choose_model,
)
from softfinger.config import read_config
from softfinger.stages.keys import choose_settings


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
    """Find out which physics was left out.

    The campaign may have any level.

    Writes OUT/verdict.json, OUT/model.yaml (the repaired model) and the artifacts behind them.
    Exit status 0: there is a verdict, whatever it is. 1: the campaign is refused.
    """
    from softfinger.mismatch.verdict.schema import read_verdict
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
        config=choose_settings(settings, "diagnose"),
        r_hat_max=settings["estimation"]["r_hat_max"],
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
