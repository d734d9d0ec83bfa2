"""Defaults and the user's file, by one schema."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator

from softfinger.faults import ListedFault
from softfinger.gate import read_document
from softfinger.provenance import PROJECT

DEFAULT_FILE = PROJECT / "config/default.yaml"
SCHEMA_FILE = PROJECT / "workflow/schemas/config.schema.yaml"


def read_config(file: Path | None = None) -> dict[str, Any]:
    """Read the configuration: defaults, overridden by a file.

    Raises
    ------
    ListedFault
        An unknown key or a value out of range; all faults are listed.
    Fault
        A file is missing or no YAML.
    """
    config = dict(read_document(DEFAULT_FILE).content)
    if file is not None:
        config = _merge(config, read_document(file).content)
    schema = read_document(SCHEMA_FILE).content
    errors = sorted(Draft202012Validator(schema).iter_errors(config), key=lambda e: list(e.path))
    if errors:
        faults = [f"{'.'.join(map(str, e.path)) or 'top level'}: {e.message}" for e in errors]
        raise ListedFault(str(file or DEFAULT_FILE), faults)
    return config


def _merge(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in over.items():
        both = isinstance(value, Mapping) and isinstance(base.get(key), Mapping)
        merged[key] = _merge(base[key], value) if both else value
    return merged
