"""Real recordings made by others; they are not part of this project."""

from pathlib import Path

import pytest

REALDATA = Path(__file__).parents[4] / "shared/realdata"


@pytest.fixture
def realdata():
    if not REALDATA.is_dir():
        pytest.skip("the real recordings (../shared/realdata) are not on this machine")
    return REALDATA
