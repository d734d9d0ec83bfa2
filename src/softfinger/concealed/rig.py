"""Finger, wire and camera of a concealed campaign."""

from dataclasses import dataclass

import numpy as np

from softfinger.concealed.arrays import Array


@dataclass(frozen=True)
class Rig:
    """Geometry that ``campaign.yaml`` declares, SI units."""

    link_length: Array  # (joint,)
    link_mass: Array  # (joint,)
    wire_offset: float
    joint_length: float
    base_marker: Array  # (2,) places along the base, from the first joint
    link_marker: Array  # (2,) places along every link, from its proximal joint
    marker_diameter: float
    metres_per_pixel: float
    fps: float

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.link_length.size


def draw_rig(rng: np.random.Generator, *, filmed: bool) -> Rig:
    """Draw a rig near the paper's, or virtual."""
    draw = (lambda low, high: 0.5 * (low + high)) if filmed else rng.uniform
    return Rig(
        link_length=np.full(3, round(draw(0.022, 0.028), 4)),
        link_mass=np.full(3, round(draw(0.004, 0.006), 4)),
        wire_offset=round(draw(0.0045, 0.0055), 5),
        joint_length=round(draw(0.007, 0.009), 5),
        base_marker=np.array([-0.018, -0.006]),
        link_marker=np.array([0.006, 0.019]),
        marker_diameter=0.004,
        metres_per_pixel=0.000235,
        fps=30.0 if filmed else float(rng.choice([20.0, 25.0, 30.0])),
    )
