"""The recordings beside the model, base and repaired."""

from softfinger.report.blocks import Paragraph, Section, keep_blocks
from softfinger.report.checks import FIT, combine_checks, list_checks, list_rings
from softfinger.report.formatting import count_things, format_number, format_percent, join_words
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_bands
from softfinger.report.pictures.repair import picture_repair
from softfinger.units import label_thousandth

FITTED = (("predictive", "bands and residuals of the fit"), ("calibration", "calibration"))


def build_motion(material: Material) -> Section:
    """Build the recordings beside the bands of the models."""
    sentences = [describe_used(material), *describe_misfit(material)]
    picture = picture_repair(material) or picture_bands(material, early=False)
    more = (("data", "the recordings"), *(FITTED if material.is_fitted else ()))
    blocks = keep_blocks(Paragraph(" ".join(sentences)), picture)
    return Section("motion", "Recordings and model", blocks, more)


def describe_used(material: Material) -> str:
    """Describe what was recorded."""
    angles = material.angles
    aside = angles["set_aside_trial"].size
    verb = "is" if angles["trial"].size == 1 else "are"
    return (
        f"{count_things(angles['trial'].size, 'trial')} of "
        f"{count_things(angles['joint'].size, 'joint')} {verb} used, "
        f"{f'{aside} set aside' if aside else 'none was set aside'}."
    )


def describe_misfit(material: Material) -> list[str]:
    """Describe the motion that trials share and the model leaves."""
    residuals = material.find("residuals")
    if residuals is None:
        return [] if "verdict" in material else ["The fit was not run."]
    sentences = []
    if combine_checks(list_checks(material, FIT)) is False:
        largest, share = float(residuals["largest_mean"].max()), residuals["largest_share"]
        sentences.append(
            "The fitted model misses motion that the trials share: up to "
            f"{format_number(1e3 * largest, 2)} {label_thousandth(material.motion_unit)} in the "
            "mean over trials, "
            f"{format_percent(float(share), 1)} of the range of the recorded angles."
        )
    rings = list_rings(material)
    if rings:
        sentences.append(
            f"After a change of load the finger rings at {join_words(rings)}, which the fitted "
            "model does not."
        )
    return sentences
