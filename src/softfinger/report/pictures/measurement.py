"""Figures of the measurement and the free laws."""

from softfinger.figures.laws import draw_laws
from softfinger.figures.measurement import draw_measurement
from softfinger.report.blocks import Picture
from softfinger.report.material import Material
from softfinger.report.pictures.repair import say_trials
from softfinger.units import label_thousandth


def picture_measurement(material: Material) -> Picture | None:
    """What the recordings suffer from, trial by trial."""
    noise = material.find("noise")
    if noise is None:
        return None
    return Picture(
        "measurement",
        "What the recordings suffer from",
        draw_measurement(noise, label_thousandth(material.motion_unit)),
        "Noise of every trial over the campaign's; share of frames that are left out of every "
        "trial; standard deviation of the noise of each joint against the deflection, and against "
        "the speed where it grows with that.",
        "Left: noise of a trial over the campaign's. Middle: frames that are gross errors, or "
        "repeat the one before. Right: growth of the noise with the deflection, and with the speed "
        "where the recordings show that. "
        f"n = {say_trials(material)}. Rule diagnose, artifact measurement.",
    )


def picture_laws(material: Material) -> Picture | None:
    """Draw the repaired model's free laws, if any."""
    if "laws" not in material or not material.get("laws").sizes.get("law", 0):
        return None
    return Picture(
        "laws",
        "The laws that the recordings ask for",
        draw_laws(material.get("laws")),
        "Free law of each effect against its argument, with a shaded band.",
        "Curve of each free law over the range that was recorded, and its 90 % band. Grey: "
        "without the effect. What lies outside the range is not known. "
        f"n = {say_trials(material)}. Rule diagnose, artifact laws.",
    )
