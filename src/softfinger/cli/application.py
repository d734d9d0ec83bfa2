"""The application, and what its verbs share.

Arguments, the model, artifacts as inputs.
"""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Context
from typer.core import TyperGroup

from softfinger.campaign import Campaign, list_tables, read_campaign
from softfinger.cli.supervision import hold_folder
from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.progress import silence_progress
from softfinger.stages.keys import choose_settings

FIRST = ("demo", "new", "import", "check", "run", "diagnose", "next", "effects", "doctor", "rig")
STEPS = "Single steps"
HELP = """\
From rig videos of a wire-driven soft finger to its posterior, its spread and a report.

Exit status of every command: 0, done and well; 1, refused or not well, and what to do; 2, the
command line is wrong; 130, interrupted.
"""


class InOrder(TyperGroup):
    """Verbs in the order of a first hour."""

    def list_commands(self, ctx: Context) -> list[str]:
        """Names of the verbs, those to begin with first."""
        places = {name: place for place, name in enumerate(FIRST)}
        return sorted(self.commands, key=lambda name: places.get(name, len(FIRST)))


app = typer.Typer(
    cls=InOrder,
    help=HELP,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

CampaignFolder = Annotated[Path, typer.Argument(help="Campaign folder.", metavar="CAMPAIGN")]
Out = Annotated[Path, typer.Option(help="Folder of the artifacts.", callback=hold_folder)]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, for programs.")]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", help="YAML file whose keys replace the defaults.")
]
PhysicsFile = Annotated[
    Path | None,
    typer.Option("--model", help="Model file (model.yaml) that replaces the base model."),
]


def show_version(wanted: bool) -> None:
    """Print the version of the installed package."""
    if wanted:
        typer.echo(f"softfinger {version('softfinger')}")
        raise typer.Exit


def show_example(command: str) -> str:
    """Last line of a verb's help."""
    return f"Example: `{command}`"


def dump_json(content: object) -> str:
    """A JSON document, for programs."""
    return json.dumps(content, indent=2, default=str, ensure_ascii=False)


@app.callback()
def options(
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", help="No progress bars; of `run`, only what goes wrong."),
    ] = False,
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Show the version and exit.", callback=show_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Options of every verb."""
    del version
    if quiet:
        silence_progress()


def choose_model(settings: dict[str, Any], given: Path | None) -> Path | None:
    """Given model file, else the configuration's, else none."""
    if given is not None or settings["model"] is None:
        return given
    return Path(settings["model"])


def open_inputs(
    campaign: Path, out: Path, config: Path | None, artifacts: list[str], stage: str
) -> dict[str, Any]:
    """Arguments of a stage after `angles`.

    The campaign must still be readable.
    """
    refuse_foreign(read_campaign(campaign), out)
    files = {name: out / f"{name}.nc" for name in artifacts}
    return files | {"config": choose_settings(read_config(config), stage)}


def refuse_foreign(campaign: Campaign, out: Path) -> None:
    """Refuse a folder of results of other recordings.

    Its angles were made from other recordings than the campaign's.

    Raises
    ------
    Fault
        OUT/angles.nc is there, and of other tables, or of these before they were changed.
    """
    from softfinger.artifacts import open_artifact
    from softfinger.artifacts.specs.angles import SPEC
    from softfinger.provenance import hash_files

    angles = out / "angles.nc"
    if not angles.exists():
        return
    made_from = json.loads(str(open_artifact(angles, SPEC).attrs["inputs"]))
    if made_from.get("tables") != hash_files(list_tables(campaign)):
        raise Fault(
            f"{angles}: was made from other recordings than those of {campaign.folder} as they "
            "are now; name the folder of this campaign's results, or run `softfinger angles` again"
        )
