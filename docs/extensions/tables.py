"""Parts of pages that are generated when the site is built, so that they cannot grow stale.

A line ``<!-- generated: NAME -->`` in a page is replaced by what the maker of that name returns.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import benchmark_page
import decisions_page
import growth_page
import typer.main
from inline_picture import embed_figure
from ruamel.yaml import YAML
from sphinx.application import Sphinx

from softfinger.artifacts.spec import ArtifactSpec, Variable
from softfinger.artifacts.specs import list_specs
from softfinger.cli import app as command_line
from softfinger.figures.effects import plot_effect
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.demonstration import demonstrate_effect
from softfinger.mechanics.effects.effect import Effect
from softfinger.mechanics.forward.slot import SLOTS
from softfinger.provenance import PROJECT
from softfinger.schema import Configuration

MARK = re.compile(r"^<!-- generated: (\w+) -->$", re.MULTILINE)


def fill_page(_: Sphinx, __: str, source: list[str]) -> None:
    """Replace every mark in a page."""
    source[0] = MARK.sub(lambda mark: MAKERS[mark[1]](), source[0])


def format_table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """Markdown table; a bar within a cell is escaped."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(c.replace('|', chr(92) + '|') for c in r)} |" for r in lines)


def describe_artifacts() -> str:
    """Every artifact: its rule, its variables and coordinates."""
    return "\n\n".join(describe_artifact(spec) for spec in list_specs())


def describe_artifact(spec: ArtifactSpec) -> str:
    """One artifact's section."""
    head = f"## `{spec.name}.nc`\n\n{spec.title}. Rule `{spec.rule}`, version {spec.version}."
    groups = {"": {**spec.variables, **spec.coords}, **spec.groups}
    rows = []
    for group, variables in groups.items():
        for name, variable in variables.items():
            rows.append(describe_variable(f"{group}/{name}" if group else name, variable))
    return f"{head}\n\n" + format_table(("name", "dims", "unit", "range", "meaning"), rows)


def describe_variable(name: str, variable: Variable) -> tuple[str, ...]:
    """One row: name, dims, unit, range, meaning."""
    bounds = (f"{variable.at_least:g}", f"{variable.at_most:g}")
    limited = bounds != ("-inf", "inf")
    where = f"{bounds[0]} to {bounds[1]}".replace("-", "−").replace("inf", "∞") if limited else ""
    meaning = variable.long_name + (" (may be absent)" if variable.optional else "")
    unit = "" if variable.units == "1" else variable.units
    return f"`{name}`", ", ".join(variable.dims), unit, where, meaning


def describe_configuration() -> str:
    """Every key of the configuration with its default, what is allowed, and its comment."""
    schema = Configuration.model_json_schema()
    text = (PROJECT / "config/default.yaml").read_text(encoding="utf-8")
    defaults = YAML(typ="safe").load(text)
    notes = dict(re.findall(r"^( *\w+):.*? # (.+)$", text, re.MULTILINE))
    rows = list(list_keys(schema, schema, defaults, notes, ""))
    return format_table(("key", "default", "allowed", "meaning"), rows)


def list_keys(
    node: Mapping[str, Any],
    schema: Mapping[str, Any],
    defaults: Mapping[str, Any],
    notes: Mapping[str, str],
    prefix: str,
) -> Iterator[tuple[str, ...]]:
    """Rows of a block of the configuration and of the blocks within it."""
    for key, declared in node["properties"].items():
        found = follow_reference(declared, schema)
        note = notes.get("  " * prefix.count(".") + key, "")
        if "properties" in found:
            yield from list_keys(found, schema, defaults[key], notes, f"{prefix}{key}.")
        else:
            if "enum" in found and "|" in note:  # the first column says so already
                note = note.partition(":")[2].strip()
            default = YAML_WORDS.get(str(defaults[key]), str(defaults[key]))
            yield f"`{prefix}{key}`", f"`{default}`", describe_type(found, schema), note


YAML_WORDS = {"None": "null", "True": "true", "False": "false"}
BOUNDS = {
    "exclusiveMinimum": "> {}",
    "minimum": "≥ {}",
    "exclusiveMaximum": "< {}",
    "maximum": "≤ {}",
}


def follow_reference(node: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """Replace a reference by what it refers to."""
    return schema["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node


def describe_type(node: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    """Type and bounds of a key in words."""
    node = follow_reference(node, schema)
    if "anyOf" in node:
        return " or ".join(describe_type(part, schema) for part in node["anyOf"])
    if "enum" in node:
        return ", ".join(f"`{value}`" for value in node["enum"])
    if "const" in node:
        return f"`{node['const']}`"
    kind = {"string": "text", "integer": "whole number"}.get(node.get("type"), node.get("type", ""))
    if kind == "array":
        inner = describe_type(node.get("items", {}), schema)
        return f"list, each a {inner}" + (
            f"; at least {node['minItems']} of them" if "minItems" in node else ""
        )
    limits = [words.format(f"{node[key]:g}") for key, words in BOUNDS.items() if key in node]
    return f"{kind} {', '.join(limits)}".strip()


def describe_effects() -> str:
    """Every effect that a diagnosis tries."""
    rows = [
        (f"`{effect.id}`", effect.level, effect.sentence, draw_effect(effect))
        for effect in list_effects().values()
    ]
    return format_table(("id", "shows", "what was left out", "with it, and without"), rows)


def describe_slots() -> str:
    """Every slot of the forward model, the base joint's first."""
    list_effects()
    rows = [
        (f"`{name}`", slot.kind, slot.unit, f"{slot.null:g}", slot.meaning)
        for name, slot in SLOTS.items()
    ]
    return format_table(("slot", "one value for each", "unit", "absent at", "meaning"), rows)


def draw_effect(effect: Effect) -> str:
    """Draw what an effect looks like, as an inline picture."""
    return embed_figure(
        plot_effect(demonstrate_effect(effect)),
        f"{effect.sentence}: a joint's angle with it in blue, without in grey",
    )


def describe_commands() -> str:
    """Every verb of the command line with its help."""
    group = typer.main.get_command(command_line)
    rows = []
    for _, command in sorted(group.commands.items()):
        inner = getattr(command, "commands", {})
        for part in inner.values() if inner else [command]:
            words = " ".join((part.help or "").split("\n\n")[0].split())
            rows.append((words, part.epilog.removeprefix("Example: ")))
    return format_table(("what it does", "example"), rows)


def describe_make() -> str:
    """Every target of the Makefile with its line of help."""
    text = (PROJECT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"^([a-z-]+):.*?## (.*)$", text, re.MULTILINE)
    rows = [(f"`make {target}`", words) for target, words in targets]
    return format_table(("command", "what it does"), rows)


MAKERS: dict[str, Callable[[], str]] = {
    "artifacts": describe_artifacts,
    "benchmarks": benchmark_page.describe_benchmarks,
    "commands": describe_commands,
    "configuration": describe_configuration,
    "decisions": decisions_page.describe_decisions,
    "effects": describe_effects,
    "slots": describe_slots,
    "growth": growth_page.describe_growth,
    "make": describe_make,
}


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the replacement."""
    app.connect("source-read", fill_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
