"""The verb `next`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from softfinger.cli.application import ConfigFile, Json, app, dump_json, show_example
from softfinger.config import read_config

EXAMPLE = "softfinger next my_results --trials 10 --max-load 8 --minutes 20 --out plan.yaml"


@app.command("next", epilog=show_example(EXAMPLE))
def plan_next_experiment(
    folder: Annotated[
        Path,
        typer.Argument(help="Folder of a diagnosis, or a campaign folder.", metavar="FOLDER"),
    ],
    out: Annotated[Path, typer.Option(help="The plan (YAML); the other files are beside it.")],
    trials: Annotated[int, typer.Option(help="Trials to plan.")] = 10,
    max_load: Annotated[
        float | None, typer.Option(help="Largest load, in its log's unit. None: as recorded.")
    ] = None,
    max_angle: Annotated[
        float | None,
        typer.Option(help="Largest joint angle [rad], or motion. None: as recorded."),
    ] = None,
    max_rate: Annotated[
        float | None, typer.Option(help="Fastest change of the load, per second. None: jumps.")
    ] = None,
    minutes: Annotated[
        float | None, typer.Option(help="Time for all trials and rests. None: trials as long.")
    ] = None,
    rest_s: Annotated[float | None, typer.Option(help="Rest between trials [s].", min=0.0)] = None,
    fps: Annotated[
        float | None, typer.Option(help="Frame rate of the camera. None: as recorded.", min=0.1)
    ] = None,
    narrow: Annotated[
        list[str] | None,
        typer.Option(help="Quantity to narrow, as k_v, spread_k_v, angle_at_10; may be repeated."),
    ] = None,
    rig: Annotated[Path | None, typer.Option(help="The rig's own plan, to build on.")] = None,
    config: ConfigFile = None,
    json: Json = False,
) -> None:
    """Plan what to record next.

    The trials that best tell apart what a verdict leaves open.

    Writes OUT (a plan for `softfinger rig record`), the load histories as CSV, a figure and what is
    expected as JSON. Exit status 0: there is a plan. 1: the limits allow nothing.
    """
    from softfinger.stages.next import Asked, next_experiment

    campaign = folder if (folder / "campaign.yaml").is_file() else None
    plan = out if out.suffix in (".yaml", ".yml") else out / "plan.yaml"
    results = folder
    if campaign is not None:
        from softfinger.cli.diagnose import write_verdict

        results = plan.parent / f"{plan.stem}_diagnosis"
        write_verdict(campaign, results, config, mcmc=False)
    found = next_experiment(
        results=results,
        plan=plan,
        asked=Asked(
            trials, max_load, max_angle, max_rate, minutes, rest_s, fps, tuple(narrow or ())
        ),
        rig=rig,
        campaign=campaign,
        seed=read_config(config)["seed"],
    )
    if json:
        typer.echo(dump_json(found))
        return
    for line in describe_found(found):
        typer.echo(line)


def describe_found(found: dict[str, Any]) -> list[str]:
    """A plan's sentences, its rivals and its files."""
    lines = [found["statement"], "", "protocol          worth [nats]   sure answer"]
    for name, part in found["compared"].items():
        sure = part["probability_sure"]
        shown = "-" if sure is None else f"{sure:.2f}"
        lines.append(f"{name:<18}{part['worth_nats']:>12.2f}{shown:>14}")
    lines += ["", f"the plan is {found['plan']}; load files: {', '.join(found['load_files'])}"]
    if not found["runs_on_rig"]:
        lines.append("for `softfinger rig record`, give the rig's own plan with --rig")
    return lines
