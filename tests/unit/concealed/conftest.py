"""A small setting that the tests of the proof share."""

import numpy as np
import pytest

from softfinger.concealed.effects import Circumstances
from softfinger.concealed.population import PAPER_MEAN
from softfinger.concealed.protocols import Load
from softfinger.concealed.rig import Rig


@pytest.fixture
def rig():
    return Rig(
        link_length=np.array([0.025, 0.024, 0.023]),
        link_mass=np.array([0.006, 0.005, 0.004]),
        wire_offset=0.005,
        joint_length=0.008,
        base_marker=np.array([-0.018, -0.006]),
        link_marker=np.array([0.006, 0.019]),
        marker_diameter=0.004,
        metres_per_pixel=0.000235,
        fps=25.0,
    )


@pytest.fixture
def individual():
    return PAPER_MEAN.copy()


@pytest.fixture
def staircase():
    """Up, part of the way down, up, off."""
    jump, level = np.array([0.5, 3.0, 6.0, 9.0]), np.array([4.0, 8.0, 5.0, 0.0])
    before = np.append(0.0, level[:-1])
    return Load(np.repeat(jump, 2), np.column_stack([before, level]).ravel())


@pytest.fixture
def circumstances(staircase):
    return Circumstances(
        number=7,
        count=10,
        load=staircase,
        duration=12.0,
        warmth=2.0,
        rest=20.0,
        luck=(0.3, 0.2, 0.6),
    )


@pytest.fixture
def time():
    return np.arange(0.0, 12.0, 0.04)
