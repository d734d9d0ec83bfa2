"""The model in words and symbols, and what its priors say before any data."""

from __future__ import annotations

from softfinger.report.blocks import Fragment, Paragraph, Section
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_prior
from softfinger.report.pictures.recordings import picture_finger, picture_joint_model


def build_model(material: Material) -> Section:
    """Build the section on the model: sketches, equations, priors on the angle scale."""
    return Section(
        "model",
        "The model, and what its priors expect",
        (
            Fragment("equations"),
            picture_finger(material),
            picture_joint_model(material),
            picture_prior(material)
            or Paragraph("This fit kept no draws of its priors, so they cannot be shown.", "note"),
        ),
    )
