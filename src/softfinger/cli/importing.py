"""Verb `import`: recordings of others as a campaign."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from softfinger.cli.application import app, show_example

if TYPE_CHECKING:
    from softfinger.importing import Found


@app.command("import", epilog=show_example("softfinger import my_files --out my_campaign"))
def import_recordings(
    source: Annotated[Path, typer.Argument(help="File or folder with recordings.")],
    out: Annotated[Path, typer.Option(help="Campaign folder to write.", metavar="CAMPAIGN")],
    spec: Annotated[
        Path | None, typer.Option(help="How to read them; CAMPAIGN/import.yaml, if it is there.")
    ] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", help="One key of it, as in --set clock.unit=ms.")
    ] = None,
    fps: Annotated[
        float | None, typer.Option(help="Frames per second, where no column is a clock.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show what is understood, and write no campaign.")
    ] = False,
    guide: Annotated[
        bool, typer.Option("--guide", help="Ask about each guess in the terminal.")
    ] = False,
) -> None:
    """Read recordings of others into a campaign.

    They are text, workbooks, tracked points or topics.

    What is not declared is guessed; all guesses are listed, and kept in CAMPAIGN/import.yaml, where
    they can be changed. Nothing that exists is overwritten.
    """
    from softfinger.campaign import check_campaign
    from softfinger.importing import (
        FILE_NAME,
        format_preview,
        read_import_description,
        read_recordings,
        refuse_existing,
        write_campaign,
    )

    if not dry_run:
        refuse_existing(out)
    if spec is None and (out / FILE_NAME).is_file():
        spec = out / FILE_NAME
    keys = [*(settings or ()), *([f"clock.frames_per_second={fps}"] if fps else [])]
    found = read_recordings(source, read_import_description(spec, keys))
    if guide:
        found = read_recordings(source, read_import_description(spec, [*keys, *_ask(found)]))
    typer.echo(format_preview(found.description, found.trials))
    _list("guessed (change it in import.yaml, or with --set KEY=VALUE)", found.guessed)
    _list("dropped", found.dropped)
    if dry_run:
        _write_dry_run(out, found)
        return
    write_campaign(out, found.description, found.trials, found.guessed)
    reasons = check_campaign(out)
    _list("set aside", [f"trial {name}: {reason}" for name, reason in reasons.items()])
    typer.echo(f"\nwrote {out}: {len(found.trials)} trials; next: softfinger check {out}")


def _list(title: str, lines: list[str]) -> None:
    if lines:
        typer.echo("\n".join(["", f"{title}:", *(f"  {line}" for line in lines)]))


def _ask(found: Found) -> list[str]:
    """Ask about each guess; return the keys changed."""
    answers = []
    for line in found.guessed:
        key, _, rest = line.partition(": ")
        value, _, why = rest.rpartition(" (")
        if "." not in key or not value:
            continue
        answer = typer.prompt(f"{key} ({why}", default=value)
        if answer != value:
            answers.append(f"{key}={answer}")
    return answers


def _write_dry_run(out: Path, found: Found) -> None:
    """Write a dry run's description and figure.

    Their names are free ones.
    """
    from softfinger.figures.imported import draw_imported
    from softfinger.figures.style import save_figure
    from softfinger.importing import FILE_NAME
    from softfinger.importing.description import format_description
    from softfinger.importing.preview import gather_curves

    out.mkdir(parents=True, exist_ok=True)
    figure = _find_free(out / "preview.png")
    save_figure(draw_imported(gather_curves(found.description, found.trials)), figure)
    written = [str(figure)]
    if not (out / FILE_NAME).exists():
        text = format_description(found.description, found.guessed)
        (out / FILE_NAME).write_text(text, encoding="utf-8")
        written.insert(0, str(out / FILE_NAME))
    typer.echo(f"\nno campaign is written; see {' and '.join(written)}")


def _find_free(path: Path) -> Path:
    number = 1
    while path.exists():
        number += 1
        path = path.with_stem(f"{path.stem.rsplit('_', 1)[0]}_{number}")
    return path
