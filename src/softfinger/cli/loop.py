"""The verb `loop`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from softfinger.cli.application import CampaignFolder, ConfigFile, Out, app, show_example
from softfinger.cli.diagnose import describe_verdict, write_verdict
from softfinger.cli.join import write_joined
from softfinger.config import read_config

EXAMPLE = (
    "softfinger loop my_campaign --out my_loop --rig "
    "'softfinger rig record {plan} --out {out} --port /dev/ttyACM0'"
)


@app.command(epilog=show_example(EXAMPLE))
def loop(
    campaign: CampaignFolder,
    out: Out,
    rig: Annotated[
        str, typer.Option(help="Command that records {plan} into {out}; it may take {round}.")
    ],
    rounds: Annotated[int, typer.Option(help="Most rounds of further recordings.", min=1)] = 2,
    trials: Annotated[int, typer.Option(help="Trials of each round.", min=1)] = 10,
    max_load: Annotated[float | None, typer.Option(help="As of `next`.")] = None,
    max_angle: Annotated[float | None, typer.Option(help="As of `next`.")] = None,
    max_rate: Annotated[float | None, typer.Option(help="As of `next`.")] = None,
    minutes: Annotated[float | None, typer.Option(help="As of `next`.")] = None,
    plan: Annotated[
        Path | None, typer.Option(help="The rig's own plan, as --rig of `next`.")
    ] = None,
    config: ConfigFile = None,
) -> None:
    """Diagnose, plan and record until sure.

    Each round is kept in OUT/round_0, round_1, …; what is there is not done again.

    Writes OUT/loop.html. Exit status 0: the last verdict is settled. 1: it is not.
    """
    from softfinger.artifacts.verdict import read_verdict
    from softfinger.stages.loop import is_settled, list_deviations, record, tell_loop
    from softfinger.stages.next import Asked, next_experiment

    asked = Asked(trials, max_load, max_angle, max_rate, minutes)
    sources, folders = [campaign], [out / "round_0"]
    seen = read_verdict(_diagnose(campaign, folders[0], config))
    tell_loop(folders, out / "loop.html")
    while not is_settled(seen) and len(folders) <= rounds:
        number, here = len(folders), out / f"round_{len(folders)}"
        if not (here / "plan.json").is_file():
            next_experiment(
                results=folders[-1] / "results",
                plan=here / "plan.yaml",
                asked=asked,
                rig=plan,
                campaign=campaign,
                seed=read_config(config)["seed"] + number,
            )
        if not (here / "deviations.json").is_file():
            record(rig, here / "plan.yaml", here / "recordings", number)
            loads = json.loads((here / "plan.json").read_text(encoding="utf-8"))["loads"]
            said = list_deviations(here / "recordings", loads)
            (here / "deviations.json").write_text(json.dumps(said), encoding="utf-8")
        sources.append(here / "recordings")
        folders.append(here)
        joined = here / "joined"
        if not (here / "results/verdict.json").is_file():
            write_joined(sources, joined, config)
        seen = read_verdict(_diagnose(joined, here, config))
        tell_loop(folders, out / "loop.html")
    for place in folders:
        for line in describe_verdict(place / "results/verdict.json"):
            typer.echo(f"{place.name}: {line}")
    typer.echo(f"the page is {out / 'loop.html'}")
    if not is_settled(seen):
        raise typer.Exit(code=1)


def _diagnose(campaign: Path, folder: Path, config: Path | None) -> Path:
    """A round's verdict, made once."""
    verdict = folder / "results/verdict.json"
    if not verdict.is_file():
        write_verdict(campaign, folder / "results", config, mcmc=False)
    return verdict
