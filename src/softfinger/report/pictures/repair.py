"""Recordings beside models, and the evidence."""

from softfinger.figures.evidence import draw_evidence, draw_ranking
from softfinger.figures.repair import draw_repair
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
    """Draw recordings with the band of each model."""
    if "repair" not in material:
        return None
    repair = material.get("repair").sel(model=list_models(material))
    misfit = material.find("misfit")
    both = repair["model"].size > 1
    of = "final" if both else "base"
    trial, like = str(misfit[f"trial_{of}"].item()), misfit[f"like_{of}"].values
    bands = (
        "each at the trial's own mode"
        if material.is_alone
        else "median and 90 % band of a new trial, predicted from the other trials"
    )
    models = "base model (red, dashed) and repaired model (blue)" if both else "base model (red)"
    most = "the repair takes away most" if both else "the base model leaves most"
    return Picture(
        "repair",
        "Recordings with both models" if both else "Recordings with the base model",
        draw_repair(repair, trial, like),
        f"Recorded angles over time with the {'bands of both models' if both else 'base model'}, "
        "one column for each joint; below, what is left of one trial.",
        f"Top: recordings under one load (thin lines) and {models}: {bands}. "
        f"Below: what is left of the trial of which {most}; grey: twice the noise. "
        f"n = {count_things(int(like.sum()), 'trial')} of {repair['trial'].size}. Rule diagnose, "
        "artifact repair.",
    )


def picture_evidence(material: Material) -> Picture | None:
    """Draw the best effects, and what the models leave."""
    if "ranking" not in material or "repair" not in material:
        return None
    ranking = material.get("ranking")
    misfit = material.find("misfit").sel(model=list_models(material))
    return Picture(
        "evidence",
        "The evidence",
        draw_evidence(ranking, material.find("evidence"), misfit),
        "Left: the largest gains of single effects over the base model, against what chance "
        "gains. Right: squared residuals of the models over the noise, by joint and time.",
        "Left: log evidence of single effects over the base model [nats; 2.3 are odds of ten to "
        f"one]; grey: largest gains in {ranking['replicate'].size} campaigns drawn from the base "
        "model. Right: mean square of the residuals over that of the noise; 1 is noise alone. "
        f"n = {say_trials(material)}. Rule diagnose, artifacts ranking and repair.",
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
