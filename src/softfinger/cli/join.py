"""The verb `join`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from softfinger.cli.application import ConfigFile, app, show_example
from softfinger.config import read_config

Campaigns = Annotated[
    list[Path], typer.Argument(help="Campaign folders of one finger.", metavar="CAMPAIGN...")
]


@app.command(epilog=show_example("softfinger join monday tuesday --out both"))
def join(
    campaigns: Campaigns,
    out: Annotated[Path, typer.Option(help="The campaign folder that is written.")],
    config: ConfigFile = None,
) -> None:
    """Join campaigns of one finger.

    Each becomes a session of one campaign.

    Loads, cameras and frame rates may differ. Exit status 1: joints, geometry or units do.
    """
    typer.echo(f"the campaign is {write_joined(campaigns, out, config)}")


def write_joined(campaigns: list[Path], out: Path, config: Path | None) -> Path:
    """Write several campaigns as one; its folder."""
    from softfinger.stages.join import join as join_folders

    return join_folders(campaigns, out, read_config(config))
