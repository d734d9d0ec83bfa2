"""Figures of where models miss, and of what could show."""

from softfinger.figures.mismatch import draw_location, draw_masking
from softfinger.report.blocks import Picture
from softfinger.report.material import Material
from softfinger.report.pictures.repair import list_models, say_trials


def picture_location(material: Material) -> Picture | None:
    """Where the models miss."""
    if "location" not in material:
        return None
    return Picture(
        "location",
        "Where the models miss",
        draw_location(material.get("location").sel(model=list_models(material))),
        "False-discovery rate of every cell of joint, phase and time since the load changed, for "
        "the base and the repaired model.",
        "Dark: the model misses there; yellow: it does not. Colour: rate of false discoveries "
        "(Benjamini, Hochberg) at which a cell counts as missed, from mean and scatter of whitened "
        f"residuals; empty: too few angles. n = {say_trials(material)}. Rule diagnose, artifact "
        "location.",
        true_colours=True,
    )


def picture_masking(material: Material) -> Picture | None:
    """What the protocol could show."""
    if "masking" not in material:
        return None
    return Picture(
        "masking",
        "What this protocol could show",
        draw_masking(material.get("masking")),
        "Share of each effect's signal that is left after refitting, its expected evidence, and "
        "which effects look alike.",
        "Left: share of an effect's signal, at twice its prior standard deviation, that the base "
        "model does not absorb, and in numbers the log evidence to expect [nats]. Right: cosine "
        "between what is left of two effects: 1 (yellow) cannot be told apart, 0 (dark) have "
        f"nothing in common. n = {say_trials(material)}. Rule diagnose, artifact masking.",
        true_colours=True,
    )
