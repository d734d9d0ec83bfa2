from pathlib import Path

import pytest
from ruamel.yaml import YAML

from softfinger.rig.plan import Plan
from softfinger.settings import read_settings

EXAMPLE = Path(__file__).parents[3] / "docs/rig/plan.yaml"


@pytest.fixture
def plan_values() -> dict:
    """The example in the documentation."""
    return YAML(typ="safe").load(EXAMPLE)


@pytest.fixture
def plan(plan_values) -> Plan:
    return read_settings(Plan, plan_values, "plan")
