"""`softfinger rig plan` on the example of the documentation, before any data."""

from pathlib import Path

import pytest

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs import visibility as spec
from softfinger.config import read_config
from softfinger.faults import Fault
from softfinger.rig.plan import read_plan
from softfinger.stages.keys import choose_settings
from softfinger.stages.rig_plan import rig_plan

PLAN = Path(__file__).parents[3] / "docs/rig/plan.yaml"


@pytest.fixture(scope="module")
def short_plan(tmp_path_factory):
    """One short step, filmed slowly: a plan that hides most effects."""
    text = PLAN.read_text()
    head = text[: text.index("profiles:")].replace("fps: 30.0", "fps: 12.0")
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    path.write_text(
        f"{head}profiles:\n  - {{name: one, shape: steps, levels_n: [6.0], hold_s: 8.0}}\n"
    )
    return path


def propose(plan, folder, wanted):
    settings = read_config(None)
    files = {"visibility": folder / "visibility.nc", "proposal": folder / "plan.yaml"}
    knobs = {"config": choose_settings(settings, "virtual_rig"), "seed": 3}
    return rig_plan(plan=plan, wanted=wanted, angles=None, **files, **knobs)


def test_a_step_gives_way_to_a_protocol_that_shows_friction_and_flow(short_plan, tmp_path):
    wanted = ["wire_friction", "yield_threshold"]
    name, _ = propose(short_plan, tmp_path, wanted)
    assert name not in ("as_planned", "step")
    again = read_plan(tmp_path / "plan.yaml")
    assert max(p.build_knots()[1].max() for p in again.profiles) <= 6.0
    written = open_artifact(tmp_path / "visibility.nc", spec.SPEC)
    shown = written["separation"].sel(effect=wanted)
    assert float(shown.sel(protocol=name).min()) > float(shown.sel(protocol="step").min())


def test_an_effect_that_no_protocol_can_have_is_named(short_plan, tmp_path):
    with pytest.raises(Fault, match="no protocol can show 'ghosts' on this rig"):
        propose(short_plan, tmp_path, ["ghosts"])
