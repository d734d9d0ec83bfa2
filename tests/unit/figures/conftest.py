import sys
from pathlib import Path

import pytest

# the artifacts of the report's tests serve the figures' tests too
sys.path.insert(0, str(Path(__file__).parents[1] / "report"))

from example_artifacts import make_artifacts


@pytest.fixture(scope="session")
def artifacts():
    made = make_artifacts(n_trial=5, n_joint=3)
    stamped = {name: part for name, part in made.items() if name != "posterior"}
    return {name: part.assign_attrs(source="synthetic") for name, part in stamped.items()}
