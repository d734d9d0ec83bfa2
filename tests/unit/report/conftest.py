import sys
from pathlib import Path

import pytest

# the fixtures' module stands beside this file; tests are no packages
sys.path.insert(0, str(Path(__file__).parent))

from example_artifacts import gather, make_artifacts, sum_up
from example_diagnosis import make_diagnosis

from softfinger.report.page import render_report


@pytest.fixture(scope="session")
def artifacts():
    return sum_up(make_artifacts())


@pytest.fixture(scope="session")
def diagnosed(artifacts):
    return sum_up(artifacts | make_diagnosis(artifacts["angles"]))


@pytest.fixture(scope="session")
def material(artifacts):
    return gather(artifacts)


@pytest.fixture(scope="session")
def page(material):
    return render_report(material)
