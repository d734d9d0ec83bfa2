"""What tests of several folders share: the finger of the paper."""

import os
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from xdist.scheduler import LoadScopeScheduling

from softfinger.mechanics.geometry import FingerGeometry

# The paper's table, joint 3's c_p as its notes advise for a simulated finger.
MU = np.array([[-2.4441, -2.2986, -1.88], [-3.6635, -3.6476, -3.8777], [2.8538, 3.1129, 3.3]])
SIGMA = np.array([[0.1973, 0.2238, 0.3957], [0.5232, 0.4838, 0.8223], [0.7011, 0.8496, 0.9]])


BESIDE = Path(__file__).parents[2] / "shared/realdata"


class FolderScheduling(LoadScopeScheduling):
    """Tests of one part share fixtures, and so one of the processes that run side by side."""

    def _split_scope(self, nodeid: str) -> str:
        folder = nodeid.split("::")[0].rpartition("/")[0]
        return "/".join(folder.split("/")[:3])  # tests/unit/mismatch, with the folders in it


def pytest_xdist_make_scheduler(config, log):
    return FolderScheduling(config, log)


FIRST = (
    *("workflow", "concealed", "report", "tracking", "importing", "rig"),
    *("mismatch", "inference", "estimation"),
)
"""Parts of the tests that begin, in this order; the others follow."""


def pytest_collection_modifyitems(items):
    """The longest first, so that no process waits for them in the end.

    While the workflow compiles what all fits need, the other process needs none of it.
    """

    def rank(item) -> int:
        parts = Path(item.nodeid).parent.parts[:3]
        return min((FIRST.index(part) for part in parts if part in FIRST), default=len(FIRST))

    items.sort(key=rank)


@pytest.fixture
def realdata():
    """Folder of real recordings made by others, which are not part of this project."""
    folder = Path(os.environ.get("SOFTFINGER_REALDATA", BESIDE))
    if not folder.is_dir():
        pytest.skip(f"there are no real recordings in {folder}; SOFTFINGER_REALDATA names a folder")
    return folder


@pytest.fixture
def geometry():
    return FingerGeometry.uniform([0.025] * 3, [0.005] * 3, 0.008, 0.005)


@pytest.fixture
def parameters():
    """Five trials of the paper's finger."""
    rng = np.random.default_rng(5)
    viscoelastic = np.exp(MU[:, None] + SIGMA[:, None] * rng.normal(size=(3, 5, 3)))
    values = [*viscoelastic, rng.normal(0.02, 0.01, (5, 3))]
    names = ("k_v", "c_v", "c_p", "q_ini")
    return xr.Dataset(
        {name: (("trial", "joint"), value) for name, value in zip(names, values, strict=True)},
        coords={"trial": [f"trial_{i}" for i in range(5)], "joint": [1, 2, 3]},
    )


@pytest.fixture
def evaluate_chain():
    """M(q) and h(q, q̇) of one configuration."""
    from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term

    def evaluate(angle, velocity, coefficients):
        matrix, term = np.empty((angle.size, angle.size)), np.empty(angle.size)
        fill_inertia_and_nonlinear_term(angle, velocity, coefficients, matrix, term)
        return matrix, term

    return evaluate
