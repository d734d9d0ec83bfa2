"""The configuration: defaults, then the user's file, checked against one schema."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator
from ruamel.yaml import YAML, YAMLError

from softfinger.faults import Fault, ListedFault
from softfinger.provenance import PROJECT

DEFAULT_FILE = PROJECT / "config/default.yaml"
SCHEMA_FILE = PROJECT / "workflow/schemas/config.schema.yaml"


def read_config(file: Path | None = None) -> dict[str, Any]:
    """Read ``config/default.yaml`` with the keys of another file, if any, put over it.

    Raises
    ------
    ListedFault
        An unknown key or a value out of range; all faults are listed.
    Fault
        A file is missing or no YAML.
    """
    config = _load_yaml(DEFAULT_FILE)
    if file is not None:
        config = _merge(config, _load_yaml(file))
    schema = _load_yaml(SCHEMA_FILE)
    errors = sorted(Draft202012Validator(schema).iter_errors(config), key=lambda e: list(e.path))
    if errors:
        faults = [f"{'.'.join(map(str, e.path)) or 'top level'}: {e.message}" for e in errors]
        raise ListedFault(str(file or DEFAULT_FILE), faults)
    return config


def _load_yaml(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise Fault(f"{path}: the file does not exist; run softfinger from its own checkout")
    try:
        content = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    except (YAMLError, UnicodeDecodeError) as error:
        raise Fault(f"{path}: it is not YAML: {' '.join(str(error).split())}") from None
    if not isinstance(content, Mapping):
        raise Fault(f"{path}: it must hold keys and values")
    return json.loads(json.dumps(content))


def _merge(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in over.items():
        both = isinstance(value, Mapping) and isinstance(base.get(key), Mapping)
        merged[key] = _merge(base[key], value) if both else value
    return merged
