import sys
from pathlib import Path

import pytest

# the artifacts of the report's tests serve these tests too
sys.path.insert(0, str(Path(__file__).parents[1] / "report"))

from example_artifacts import make_artifacts


@pytest.fixture(scope="session")
def artifacts():
    return make_artifacts()
