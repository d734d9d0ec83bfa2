"""Verbs of `softfinger rig` for campaigns.

Those that need no campaign are with the rig itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from softfinger.cli.application import ConfigFile, Json, Out, app, dump_json, show_example
from softfinger.config import read_config
from softfinger.rig.cli import app as rig_app

app.add_typer(rig_app, name="rig")


@rig_app.command(
    "plan", epilog=show_example("softfinger rig plan plan.yaml --out my_plan --tell-apart inertia")
)
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
    json: Json = False,
) -> None:
    """Propose profiles that show what to tell apart.

    Writes OUT/plan.yaml and OUT/visibility.nc.

    Exit status 0: there is a proposal. 1: no protocol within the plan's limits would show it.
    """
    from softfinger.stages.keys import choose_settings
    from softfinger.stages.prepare import prepare_angles
    from softfinger.stages.rig_plan import rig_plan

    settings = read_config(config)
    found = rig_plan(
        plan=plan,
        wanted=tell_apart or [],
        angles=prepare_angles(campaign, out, settings) if campaign else None,
        visibility=out / "visibility.nc",
        proposal=out / "plan.yaml",
        config=choose_settings(settings, "virtual_rig"),
        seed=settings["seed"],
    )
    if json:
        said = {} if found is None else {"protocol": found[0], "plan": out / "plan.yaml"}
        typer.echo(dump_json(said | {"visibility": out / "visibility.nc"}))
        raise typer.Exit(code=1 if found is None else 0)
    if found is None:
        typer.echo("no protocol within the plan's limits would show any of them")
        raise typer.Exit(code=1)
    best, table = found
    gains = table["expected_gain"].transpose("effect", "protocol").to_pandas()
    typer.echo("evidence to expect [nats] of an effect of usual strength, in a dozen trials:")
    typer.echo(gains.to_string(na_rep="-", float_format="{:.3g}".format))
    typer.echo(f"proposed: {best}; its profiles are in {out / 'plan.yaml'}")
