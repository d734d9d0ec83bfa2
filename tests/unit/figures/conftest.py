import sys
from pathlib import Path

import pytest
import xarray as xr

# the artifacts of the report's tests serve the figures' tests too
sys.path.insert(0, str(Path(__file__).parents[1] / "report"))

from example_artifacts import make_artifacts, sum_up


@pytest.fixture(scope="session")
def artifacts():
    made = sum_up(make_artifacts(n_trial=5, n_joint=3))
    trees = {name: part for name, part in made.items() if isinstance(part, xr.DataTree)}
    rest = {
        name: part.assign_attrs(source="synthetic")
        for name, part in made.items()
        if name not in trees
    }
    return rest | trees


@pytest.fixture(scope="session")
def find(artifacts):
    """A group of the artifacts `checks` and `summary`, stamped."""

    def look(group):
        tree = next(artifacts[n] for n in ("checks", "summary") if group in artifacts[n].children)
        return tree[group].to_dataset().assign_attrs(source="synthetic")

    return look
