"""The configuration's schema, generated from the declared blocks.

``python -m softfinger.schema workflow/schemas/config.schema.yaml`` renews the file, from which the
workflow is checked before it starts, without importing the packages; a test finds drift.
"""

import io
import sys
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field
from ruamel.yaml import YAML

from softfinger.estimation.config import EstimationConfig
from softfinger.mismatch.config import MismatchSettings
from softfinger.propagation.config import PropagationConfig
from softfinger.settings import Settings
from softfinger.summary.config import ReportConfig
from softfinger.tracking.config import TrackingConfig
from softfinger.virtual_rig.config import VirtualRigConfig


class Configuration(Settings):
    """Every setting, once."""

    campaign: str | Annotated[list[str], Field(min_length=2)] | None
    model: str | None
    out: Annotated[str, Field(min_length=1)]
    seed: Annotated[int, Field(ge=0)]
    trials_per_job: Annotated[int, Field(ge=1)]
    virtual_rig: VirtualRigConfig
    tracking: TrackingConfig
    estimation: EstimationConfig
    propagation: PropagationConfig
    mismatch: MismatchSettings
    report: ReportConfig


def format_schema() -> str:
    """JSON schema of the configuration, as YAML."""
    stream = io.StringIO()
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    YAML().dump(dialect | _drop_titles(Configuration.model_json_schema()), stream)
    head = "# Generated from the declared blocks; renew with: python -m softfinger.schema FILE\n"
    return head + stream.getvalue()


def _drop_titles(node: Any) -> Any:  # noqa: ANN401 (a JSON tree contains anything)
    if isinstance(node, dict):
        kept = {key: _drop_titles(value) for key, value in node.items()}
        return {k: v for k, v in kept.items() if not (k == "title" and isinstance(v, str))}
    return [_drop_titles(value) for value in node] if isinstance(node, list) else node


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(format_schema(), encoding="utf-8")
