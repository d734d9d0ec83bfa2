"""The verb `diagnose`."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from softfinger.cli.application import (
    ConfigFile,
    Json,
    Out,
    PhysicsFile,
    app,
    choose_model,
    show_example,
)
from softfinger.cli.join import Campaigns, write_joined
from softfinger.cli.results import report, summarise
from softfinger.config import read_config
from softfinger.stages.keys import choose_settings

if TYPE_CHECKING:
    from softfinger.artifacts.verdict import Verdict


@app.command(epilog=show_example("softfinger diagnose my_campaign --out my_results"))
def diagnose(
    campaigns: Campaigns,
    out: Out,
    config: ConfigFile = None,
    model: PhysicsFile = None,
    mcmc: Annotated[
        bool | None, typer.Option("--mcmc/--no-mcmc", help="Sample the repaired model.")
    ] = None,
    page: Annotated[
        bool, typer.Option("--report/--no-report", help="Write OUT/report.html too.")
    ] = True,
    json: Json = False,
) -> None:
    """Find out which physics was left out.

    The campaign may have any level. Several are campaigns of one finger, a session each, and are
    joined in OUT/joined first.

    Writes OUT/verdict.json, OUT/model.yaml (the repaired model), OUT/survivors.yaml (the models
    that are left), the artifacts behind them and OUT/report.html. Where OUT has a fit
    too, the report is that of both.
    Exit status 0: there is a verdict, whatever it is. 1: the campaign is refused.
    """
    (campaign, *others) = campaigns
    if others:
        campaign = write_joined(campaigns, out / "joined", config)
    file = write_verdict(campaign, out, config, model, mcmc)
    if page:
        summarise(campaign, out, config, model)
        report(campaign, out, config)
    if json:
        typer.echo(file.read_text(encoding="utf-8"), nl=False)
        return
    for line in describe_verdict(file):
        typer.echo(line)
    if page:
        typer.echo(f"the report is {out / 'report.html'}")


def write_verdict(
    campaign: Path,
    out: Path,
    config: Path | None = None,
    model: Path | None = None,
    mcmc: bool | None = None,
) -> Path:
    """Diagnose a campaign; the file of the verdict.

    What is said on the way goes to standard error.
    """
    from softfinger.stages.diagnose import SPECS, diagnose
    from softfinger.stages.prepare import prepare_angles

    settings, verdict = read_config(config), out / "verdict.json"
    if mcmc is not None:
        settings["mismatch"]["sample_repaired"] = mcmc
    with contextlib.redirect_stdout(sys.stderr):
        diagnose(
            angles=prepare_angles(campaign, out, settings),
            verdict=verdict,
            repaired=out / "model.yaml",
            survivors=out / "survivors.yaml",
            next_experiment=out / "next_experiment",
            config=choose_settings(settings, "diagnose"),
            r_hat_max=settings["estimation"]["r_hat_max"],
            seed=settings["seed"],
            model=choose_model(settings, model),
            **{name: out / f"{name}.nc" for name in SPECS},
        )
    return verdict


def describe_verdict(file: Path) -> Iterator[str]:
    """Decision, effects, what they leave and next experiment, in sentences."""
    from softfinger.artifacts.verdict import read_verdict

    verdict = read_verdict(file)
    yield f"{verdict.campaign}: {verdict.decision}"
    yield from (effect.statement for effect in verdict.effects)
    if verdict.decision == "unlisted":
        yield from state_rest(verdict)
    if verdict.next_experiment:
        yield str(verdict.next_experiment["statement"])


def state_rest(verdict: Verdict) -> Iterator[str]:
    """What listed effects explain of it, and where the rest is."""
    if verdict.explained:
        best = verdict.explained[0]
        names = " and ".join(name.replace("_", " ") for name in best.effects)
        yield f"The best listed set, {names}, explains {best.share:.0%} of what is missing."
    else:
        yield "No listed effect explains what is missing."
    rest = verdict.remaining
    if rest is not None and rest.rms_over_noise > 1.0:
        size = f"{rest.rms_over_noise:.2f} times what the measurement allows"
        yield f"What remains is {size}: {rest.where}."
