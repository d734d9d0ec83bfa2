"""The model in words, symbols and prior expectations."""

from softfinger.report.blocks import Fragment, Paragraph, Section
from softfinger.report.formatting import join_words
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_prior
from softfinger.report.pictures.recordings import picture_finger, picture_joint_model
from softfinger.report.sections.parameters import list_fitted_effects


def build_model_section(material: Material) -> Section:
    """Section with sketches, equations and priors.

    Priors are shown on the angle scale.
    """
    return Section(
        "model",
        "The model, and what its priors expect",
        (
            Fragment("equations"),
            Paragraph(describe_additions(material)),
            picture_finger(material),
            picture_joint_model(material),
            picture_prior(material)
            or Paragraph("This fit kept no draws of its priors, so they cannot be shown.", "note"),
        ),
    )


def describe_additions(material: Material) -> str:
    """Tell what the fitted model has beyond its joints."""
    effects = list_fitted_effects(material)
    if effects:
        return f"To this the fitted model adds {join_words(effects)}, the same in every trial."
    return "Inertia is left out, and the torque does not depend on the angle."
