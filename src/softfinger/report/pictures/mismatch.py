"""Figures of the diagnosis."""

from __future__ import annotations

from softfinger.figures.mismatch import (
    draw_location,
    draw_masking,
    draw_ranking,
    draw_repair,
)
from softfinger.report.blocks import Picture
from softfinger.report.formatting import count_things
from softfinger.report.material import Material


def say_trials(material: Material) -> str:
    """Count the trials that the diagnosis used."""
    return count_things(material.angles["trial"].size, "trial")


def list_models(material: Material) -> list[str]:
    """Models to show: base, and repaired if different."""
    repaired = "verdict" not in material or material.artifacts["verdict"]["effects"]
    return ["base", "final"] if repaired else ["base"]


def picture_repair(material: Material) -> Picture | None:
    """Draw a recording, both models and their residuals."""
    if "repair" not in material:
        return None
    repair = material.get("repair").sel(model=list_models(material))
    both = repair["model"].size > 1
    misfit = material.find("misfit").sel(model=repair["model"])
    trial = str(misfit["trial_final" if both else "trial_base"].item())
    models, most = (
        ("both models", "the repair takes away most")
        if both
        else ("the base model", "the base model leaves most")
    )
    return Picture(
        "repair",
        "The fit before and after" if both else "The fit of the base model",
        draw_repair(repair, misfit, trial),
        f"Recording and {models} of one trial; what is left over time; and the squared residuals "
        "of all trials over their noise.",
        f"Top: recording (dots: means of bins) and {models} at the trial's own mode, in the "
        f"trial of which {most}, {trial}. Middle: what is left "
        "of it; grey: twice the standard deviation of the noise of a bin. Bottom: mean "
        f"square of the residuals of n = {count_things(repair['trial'].size, 'trial')} over that "
        "of the noise, which was estimated without a model; 1 is noise alone. Rule diagnose, "
        "artifact repair.",
    )


def picture_ranking(material: Material) -> Picture | None:
    """The evidence of every effect."""
    if "ranking" not in material:
        return None
    ranking = material.get("ranking")
    return Picture(
        "ranking",
        "The evidence of every effect that was fitted",
        draw_ranking(ranking, material.find("evidence")),
        "Gain of each effect's best form over the base model, against what chance gains.",
        "Log evidence over the base model [nats; 2.3 are odds of ten to one] of the best form of "
        "each effect alone, each trial's own parameters integrated; logarithmic beyond ± 1. Blue: "
        "needed beside all others. Grey: largest gains over the whole catalogue in "
        f"{ranking['replicate'].size} campaigns drawn from the base model. Dotted: gain that "
        "chance exceeds with the stated false-alarm probability. "
        f"n = {say_trials(material)}. Rule diagnose, artifact ranking.",
    )


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
        "model does not swallow, and in numbers the log evidence to expect [nats]. Right: cosine "
        "between what is left of two effects: 1 (yellow) cannot be told apart, 0 (dark) have "
        f"nothing in common. n = {say_trials(material)}. Rule diagnose, artifact masking.",
        true_colours=True,
    )
