"""The application, and what its verbs share: arguments, the model, artifacts as inputs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from softfinger.campaign import read_campaign
from softfinger.config import read_config
from softfinger.progress import silence_progress

app = typer.Typer(
    help="From rig videos of a wire-driven soft finger to its posterior, its spread and a report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

CampaignFolder = Annotated[Path, typer.Argument(help="Campaign folder.", metavar="CAMPAIGN")]
Out = Annotated[Path, typer.Option(help="Folder that holds the artifacts.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, for programs.")]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", help="YAML file whose keys replace the defaults.")
]
PhysicsFile = Annotated[
    Path | None,
    typer.Option("--model", help="Model file (model.yaml) that replaces the base model."),
]


@app.callback()
def options(
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", help="No progress bars; of `run`, only what goes wrong."),
    ] = False,
) -> None:
    """From rig videos of a wire-driven soft finger to its posterior, its spread and a report."""
    if quiet:
        silence_progress()


def choose_model(settings: dict[str, Any], given: Path | None) -> Path | None:
    """Model file that was given, else the configuration's, else none."""
    if given is not None or settings["model"] is None:
        return given
    return Path(settings["model"])


def open_inputs(
    campaign: Path, out: Path, config: Path | None, artifacts: list[str], block: str
) -> dict[str, Any]:
    """Arguments that the stages after `angles` share; the campaign must still be readable."""
    read_campaign(campaign)
    settings = read_config(config)
    files = {name: out / f"{name}.nc" for name in artifacts}
    return files | {"config": settings[block], "seed": settings["seed"]}
