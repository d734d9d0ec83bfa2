"""Rule `assumptions`: whether inertia and moment arm matter."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs.assumptions import SPEC
from softfinger.mechanics.assumptions import check_assumptions
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.provenance import derive_seed, describe_run
from softfinger.virtual_rig.population import draw_finger_parameters

FINGERS = 100
"""As many as the paper has trials."""


def assumptions(*, assumptions: Path, config: Mapping[str, Any], seed: int) -> None:
    """Compare the step solution with the full motion.

    Parameters
    ----------
    config
        The block `virtual_rig`: the finger's geometry, its largest tension and the frame rate.
    """
    geometry = FingerGeometry.uniform(
        config["link_length_m"],
        config["link_mass_kg"],
        config["joint_length_m"],
        config["wire_offset_m"],
    )
    tension = max(config["load_tension_n"])
    fingers = draw_finger_parameters(FINGERS, derive_seed(seed, "assumptions"))
    result = check_assumptions(fingers, geometry, tension, config["fps"]).assign_attrs(
        tension_n=tension,
        wire_offset_m=geometry.wire_offset,
        joint_length_m=geometry.joint_length,
    )
    save_artifact(result, SPEC, assumptions, describe_run("assumptions", {}, config, seed))
