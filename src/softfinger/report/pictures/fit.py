"""Figures of priors, sampler, bands and residuals."""

from softfinger.figures.bands import MOST_PROTOCOLS, draw_bands
from softfinger.figures.prior import draw_prior_predictive
from softfinger.figures.residuals import draw_residuals
from softfinger.figures.sampling import draw_sampling
from softfinger.report.blocks import Picture
from softfinger.report.checks import list_rings
from softfinger.report.formatting import (
    capital,
    count_things,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material

DARK = "black, or white on a dark page"
EARLY = 1.0
"""End of the early look at the bands [s]."""


def picture_prior(material: Material) -> Picture | None:
    """What the priors expect."""
    prior = material.find("prior_predictive")
    if prior is None:
        return None
    load = f"{format_number(float(prior['load']))} {material.load_unit}"
    return Picture(
        "prior_predictive",
        "What the priors alone expect",
        draw_prior_predictive(prior),
        "Bands of the joint angle over time under the priors, much wider than the recordings, "
        "which form a narrow band.",
        "Joint angle of a new trial that the priors expect before any recording is seen (blue, "
        f"equal-tailed intervals), and the span of the recordings ({DARK}), at a load of {load}. "
        "Priors that cannot reach the recordings would decide the answer. "
        f"n = {count_things(material.angles['trial'].size, 'trial')}. "
        f"{capital(material.cite('posterior', 'angles'))}.",
    )


def picture_sampling(material: Material) -> Picture | None:
    """Convergence."""
    worst = material.find("sampling")
    if worst is None:
        return None
    sampling = material.get("sampling")
    return Picture(
        "sampling",
        "Convergence of the sampler",
        draw_sampling(sampling, worst),
        "Sorted R-hat and effective numbers of draws of all hyperparameters against their limits, "
        "and the draws of the one whose chains agree least.",
        f"R-hat and effective draws of all {sampling['quantity'].size} hyperparameters, sorted, "
        f"with their limits. Right: draws and running means of "
        f"{name_quantity(worst['worst_quantity'].item())}, whose chains agree least. "
        f"{capital(material.cite('sampling', 'posterior'))}.",
    )


def name_quantity(quantity: str) -> str:
    """Write the name of a hyperparameter as words.

    >>> name_quantity("sigma_log_c_p[2]"), name_quantity("noise_sd[1]")
    ('the spread of log_c_p at joint 2', 'the noise sd at joint 1')
    """
    name, _, joint = quantity.rstrip("]").partition("[")
    kind, _, rest = name.partition("_")
    words = {"mu": f"the centre of {rest}", "sigma": f"the spread of {rest}"}.get(
        kind, f"the {name.replace('_', ' ')}"
    )
    return f"{words} at joint {joint}" if joint else words


def picture_bands(material: Material, *, early: bool) -> Picture | None:
    """Draw recordings against the model.

    The time is all of it, or the first second.
    """
    if "bands" not in material:
        return None
    bands = material.bands
    span = bands["quantile"].values[[0, -1]]
    share = format_percent(float(span[1] - span[0]))
    hidden = bands["protocol"].size - MOST_PROTOCOLS
    cut = f" The {MOST_PROTOCOLS} protocols of most trials are shown, {hidden} are not."
    n = int(bands["protocol_trials"].sum())
    title = "the first second" if early else "all of it"
    return Picture(
        "bands_early" if early else "bands",
        f"Recordings against model: {title}",
        draw_bands(bands, EARLY if early else None),
        f"Predictive bands of the joint angle beside the recordings, {title}.",
        f"Blue: posterior predictive median and {share} equal-tailed interval for a new trial; "
        f"red, dashed: the same interval of the two-stage estimate; {DARK}: median and {share} "
        f"interval (dotted) of the recordings. n = {count_things(n, 'trial')} in "
        f"{count_things(bands['protocol'].size, 'protocol')}.{cut if hidden > 0 else ''} "
        f"{capital(material.cite('bands'))}.",
    )


def picture_residuals(material: Material) -> Picture | None:
    """What the fit leaves."""
    residuals = material.find("residuals")
    if residuals is None:
        return None
    rings = list_rings(material)
    seen = f" A ring of {join_words(rings)} is far above the rest." if rings else ""
    n = int(residuals["n_segments"].sum())
    return Picture(
        "residuals",
        "What the model leaves",
        draw_residuals(residuals),
        "Mean of recording minus model over the time since the load changed, with the band that "
        f"chance would leave, and its spectrum.{seen}",
        "Left: recording minus model at each trial's posterior mean parameters, the mean over "
        f"n = {n} {'stretch' if n == 1 else 'stretches'} after a change of load; grey: two "
        "standard errors about zero, what chance leaves. Motion outside the grey is shared by the "
        "trials and missing in the model. "
        "Right: the power of the residual times frequency; equal areas are equal variance, and a "
        f"narrow peak is a ring.{seen} {capital(material.cite('posterior', 'angles'))}.",
    )
