"""Where every number comes from; how to repeat."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

from softfinger.report.blocks import Block, Fragment, Paragraph, Section, Table, text
from softfinger.report.material import Material

SHORT = 12
"""Characters of a hash that are shown; the whole one is in the artifact."""


def build_origin(material: Material) -> Section:
    """Build the provenance block."""
    commit = material.commit or "not given"
    blocks: list[Block] = [
        Paragraph(
            f"Commit of the code: {commit}. Every artifact carries the hashes of its inputs, its "
            "settings, the code it used and the environment; same hashes, same numbers. No clock "
            "enters, so the same artifacts give the same report, byte for byte."
        ),
        Fragment("rerun"),
        build_artifact_table(material),
    ]
    if material.config:
        blocks.append(build_config_table(material.config))
    return Section("origin", "Where the numbers come from", tuple(blocks))


def build_artifact_table(material: Material) -> Table:
    """Table of every artifact's provenance.

    The artifacts are those that the report reads.
    """
    rows = []
    for name, artifact in material.artifacts.items():
        attrs = getattr(artifact, "attrs", {})
        inputs = json.loads(attrs.get("inputs", "{}"))
        rows.append(
            (
                text(name),
                text(attrs.get("stage", "–")),
                text(attrs.get("schema_version", "–")),
                text(", ".join(f"{role} {shorten(sha)}" for role, sha in inputs.items()) or "–"),
                text(shorten(attrs.get("params_sha256", "–"))),
                text(shorten(attrs.get("code_sha256", "–"))),
                text(shorten(attrs.get("environment_sha256", "–"))),
                text(attrs.get("seed", "–")),
            )
        )
    columns = ("artifact", "rule", "schema", "inputs", "settings", "code", "environment", "seed")
    caption = "All that this report reads; hashes are SHA-256, their first 12 characters."
    return Table("artifacts", "Artifacts", caption, columns, tuple(rows))


def shorten(sha: str) -> str:
    """Shorten a hash for reading."""
    return str(sha)[:SHORT]


def build_config_table(config: Mapping[str, Any]) -> Table:
    """Table of the configuration, without folders.

    Folders belong to a machine, and not to a result.
    """
    rows = tuple(
        (text(key), text(value)) for key, value in flatten(config) if key not in {"campaign", "out"}
    )
    caption = "Every setting, its unit in the key."
    return Table("configuration", "Configuration", caption, ("key", "value"), rows, folded=True)


def flatten(config: Mapping[str, Any], lead: str = "") -> Iterator[tuple[str, Any]]:
    """Flatten nested settings to dotted keys.

    >>> list(flatten({"a": {"b": 1}}))
    [('a.b', 1)]
    """
    for key, value in config.items():
        if isinstance(value, Mapping):
            yield from flatten(value, f"{lead}{key}.")
        else:
            yield f"{lead}{key}", value
