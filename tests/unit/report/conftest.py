import sys
from pathlib import Path

import pytest

# the fixtures' module stands beside this file; tests are no packages
sys.path.insert(0, str(Path(__file__).parent))

from example_artifacts import CONFIG, make_artifacts
from example_diagnosis import make_diagnosis

from softfinger.report.config import read_config
from softfinger.report.material import Material
from softfinger.report.page import render_report


@pytest.fixture(scope="session")
def artifacts():
    return make_artifacts()


@pytest.fixture(scope="session")
def diagnosed(artifacts):
    return artifacts | make_diagnosis(artifacts["angles"])


@pytest.fixture(scope="session")
def material(artifacts):
    return Material(artifacts, read_config(CONFIG), CONFIG)


@pytest.fixture(scope="session")
def page(material):
    return render_report(material)
