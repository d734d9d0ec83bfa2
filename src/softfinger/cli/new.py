"""Verb `new`: a campaign folder to fill in."""

from pathlib import Path
from typing import Annotated

import typer

from softfinger.cli.application import Json, app, dump_json, show_example


@app.command(epilog=show_example("softfinger new my_campaign --video"))
def new(
    campaign: Annotated[Path, typer.Argument(help="Folder to write.", metavar="CAMPAIGN")],
    specimen: Annotated[
        bool, typer.Option("--specimen", help="Of a specimen with one motion, not of a finger.")
    ] = False,
    video: Annotated[
        bool, typer.Option("--video", help="The recordings are videos: declare the camera.")
    ] = False,
    json: Json = False,
) -> None:
    """Write a campaign folder to fill in.

    Each key of its campaign.yaml has a comment. Nothing that exists is overwritten; `check` lists
    what is still to be filled in.
    """
    from softfinger.campaign.template import write_template

    files = write_template(campaign, specimen=specimen, video=video)
    if json:
        typer.echo(dump_json({"campaign": campaign, "to_fill_in": files}))
        return
    typer.echo(f"wrote {campaign}; fill in {' and '.join(str(file) for file in files)}")
    typer.echo(f"next: softfinger check {campaign}")
