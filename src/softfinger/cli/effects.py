"""Verb `effects`: the catalogue in the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from softfinger.cli.application import Json, app, dump_json, show_example

if TYPE_CHECKING:
    import xarray as xr

    from softfinger.stages.effects import DeclaredEffect

OWN = "one object in one file of your own package: docs/own/effect.md, example docs/own_effect"
TERMS_SHOWN = 4


def complete_effect(incomplete: str) -> list[str]:
    """Ids that begin with what was typed."""
    from softfinger.mechanics.effects import list_effects

    return [name for name in list_effects() if name.startswith(incomplete)]


@app.command(epilog=show_example("softfinger effects wire_friction --picture friction.png"))
def effects(
    name: Annotated[
        str | None,
        typer.Argument(help="Id of one effect.", metavar="ID", autocompletion=complete_effect),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Write its picture too, as PNG, PDF or SVG.")
    ] = None,
    plot: Annotated[bool, typer.Option("--plot/--no-plot", help="Draw it in the terminal.")] = True,
    json: Json = False,
) -> None:
    """List the physics that a diagnosis can name.

    With an ID: what it is, where it acts, its law and forms, which recordings show it, what it
    looks like.
    """
    from softfinger.mechanics.effects import list_effects
    from softfinger.stages.effects import LEVELS, describe_effect, find_effect

    if name is None:
        catalogue = list_effects().values()
        rows = [{"id": e.id, "sentence": e.sentence, "shows": LEVELS[e.level]} for e in catalogue]
        width = max(len(row["id"]) for row in rows)
        lines = (f"{row['id']:{width}}  {row['sentence']}" for row in rows)
        typer.echo(dump_json(rows) if json else "\n".join(lines))
        return
    effect = find_effect(name)
    described = describe_effect(effect)
    if json:
        typer.echo(dump_json(asdict(described)))
    else:
        typer.echo("\n".join(format_effect(described)))
    if picture is None and (json or not plot):
        return
    from softfinger.mechanics.effects.demonstration import demonstrate_effect

    shown = demonstrate_effect(effect)
    if plot and not json:
        typer.echo("\n".join(["", *draw_effect(shown)]))
    if picture is not None:
        save_picture(shown, picture)


def format_effect(described: DeclaredEffect) -> Iterator[str]:
    """Lines on one effect."""
    yield f"{described.id}: {described.sentence}"
    yield from _list("shows", [described.shows])
    yield from _list("changes", list(described.place))
    forms = [f"{form}: {_shorten(names)}" for form, names in described.forms.items()]
    yield from _list("forms", forms)
    yield from _list("free law", [described.law or "none"])
    needs = [f"{what} ({reason})" for what, reason in described.requires.items()]
    yield from _list("recordings need", needs or ["any finger's or specimen's will do"])
    helps = [f"{what} ({count} forms more)" for what, count in described.helps.items()]
    yield from _list("it helps to have", helps)
    yield from _list("about", [" ".join(part.split()) for part in described.about.split("\n\n")])
    yield from _list("declared in", [described.source])
    yield from _list("to add one", [OWN])


def _list(title: str, items: list[str]) -> Iterator[str]:
    for number, item in enumerate(items):
        head = "" if number else title
        yield from textwrap.wrap(
            item,
            100,
            initial_indent=f"{head:18}",
            subsequent_indent=" " * 20,
            break_on_hyphens=False,
        )


def _shorten(names: tuple[str, ...]) -> str:
    if len(names) <= TERMS_SHOWN:
        return ", ".join(names)
    return f"{', '.join(names[:2])}, … {names[-1]} ({len(names)} in all)"


def draw_effect(shown: xr.Dataset) -> list[str]:
    """Lines of a plot, with and without the effect."""
    from softfinger.cli.text_plot import plot_text
    from softfinger.figures.effects import choose_curves

    curves, label = choose_curves(shown)
    pair = {f"{sign} {model} it": curves.sel(model=model) for sign, model in SIGNS.items()}
    return plot_text(curves[curves.dims[-1]], pair, f"joint angle [rad] against {label}")


SIGNS = {"·": "without", "●": "with"}


def save_picture(shown: xr.Dataset, file: Path) -> None:
    """Write the picture of the documentation."""
    from softfinger.figures.effects import plot_effect
    from softfinger.figures.style import save_figure

    file.parent.mkdir(parents=True, exist_ok=True)
    save_figure(plot_effect(shown), file)
    typer.echo(f"wrote {file}", err=True)
