"""Every figure of the report, with its alternative text and its caption.

A caption says what is seen, which rule and artifact it comes from, how many trials, and which
interval. A picture whose artifact is missing is None.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from softfinger.figures.bands import MOST_PROTOCOLS, draw_bands
from softfinger.figures.hyperparameters import draw_hyperparameters
from softfinger.figures.population import draw_initial_angles, draw_parameter_histograms
from softfinger.figures.prior import draw_prior_predictive
from softfinger.figures.propagation import draw_densities, draw_shapley, draw_sobol
from softfinger.figures.recordings import draw_recordings
from softfinger.figures.residuals import draw_residuals
from softfinger.figures.sampling import draw_sampling
from softfinger.figures.sketches import draw_finger_sketch, draw_joint_model_sketch
from softfinger.figures.tracking import choose_frame, draw_tracking
from softfinger.report.blocks import Picture
from softfinger.report.formatting import (
    capital,
    count_things,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.summaries import stack_population

DARK = "black, or white on a dark page"
EARLY = 1.0
"""End of the early look at the bands [s]."""


def picture_finger(material: Material) -> Picture:
    """The finger's geometry."""
    n_joint = material.angles["joint"].size
    wires = "tension_n" in material.angles["load_kind"].values.astype(str)
    wire_words = "; d is the distance of the wire from the middle plane" if wires else ""
    return Picture(
        "finger",
        "The finger and its angles",
        draw_finger_sketch(n_joint, wires=wires),
        f"Sketch of a finger of {count_things(n_joint, 'joint')} seen from above: a base, links "
        f"with two markers each{', the pulled wire' if wires else ''}, and each joint's angle.",
        "Sketch, drawn by code. q is each joint's angle relative to the link before, "
        f"counter-clockwise positive{wire_words}.",
    )


def picture_joint_model(material: Material) -> Picture:
    """The joint's springs and dashpots."""
    del material
    return Picture(
        "joint_model",
        "The model of one joint",
        draw_joint_model_sketch(),
        "A spring k_v beside a dashpot c_v, in series with a dashpot c_p, pulled by the torque τ.",
        "Sketch, drawn by code. The spring k_v with the dashpot c_v beside it recovers (q_v); the "
        "dashpot c_p in series flows for good (q_p).",
    )


def picture_recordings(material: Material) -> Picture:
    """All recordings."""
    angles = material.angles
    return Picture(
        "recordings",
        "What was recorded",
        draw_recordings(angles),
        f"Joint angle over time of every trial, one panel for each of {angles['joint'].size} "
        "joints, with the load below.",
        f"Every trial's joint angles and load; masked frames leave gaps. "
        f"n = {count_things(angles['trial'].size, 'trial')}. {capital(material.cite('angles'))}.",
    )


def picture_tracking(material: Material) -> Picture | None:
    """One frame with its markers."""
    if "markers" not in material:
        return None
    markers = material.get("markers")
    image = material.artifacts["picture"]["picture"] if "picture" in material else None
    trial, frame = choose_frame(markers, image)
    sd = float(np.nanmedian(markers["marker_position_sd"].sel(trial=trial)))
    where = "on the picture itself" if image is not None else "without its picture"
    return Picture(
        "tracking",
        "What the tracking saw",
        draw_tracking(markers, image),
        f"Markers found in one frame of trial {trial}: rings on base and links, with their paths.",
        f"Frame {frame} of trial {trial}, {where}: rings are markers, a red cross marks a "
        f"doubtful one, thin lines are their paths over the trial. Median standard deviation of "
        f"a coordinate: {format_number(sd, 2)} px. {capital(material.cite('markers'))}.",
        photograph=image is not None,
    )


def picture_prior(material: Material) -> Picture | None:
    """What the priors expect."""
    prior = material.prior_predictive
    if prior is None:
        return None
    load = f"{format_number(prior.attrs['load'])} {material.load_unit}"
    return Picture(
        "prior_predictive",
        "What the priors alone expect",
        draw_prior_predictive(prior),
        "Bands of the joint angle over time under the priors, much wider than the recordings, "
        "which form a narrow band.",
        "Joint angle of a new trial that the priors expect before any recording is seen (blue, "
        f"equal-tailed intervals), and the span of the recordings ({DARK}), at a load of {load}. "
        "Priors that cannot reach the recordings would decide the answer. "
        f"{capital(material.cite('posterior', 'angles'))}.",
    )


def picture_sampling(material: Material) -> Picture | None:
    """Convergence."""
    sampling = material.sampling
    if sampling is None:
        return None
    return Picture(
        "sampling",
        "Convergence of the sampler",
        draw_sampling(sampling),
        "Sorted R-hat and effective numbers of draws of all hyperparameters against their limits, "
        "and the draws of the one whose chains agree least.",
        f"R-hat and effective draws of all {sampling['quantity'].size} hyperparameters, sorted, "
        f"with their limits. Right: draws and running means of "
        f"{sampling['worst_quantity'].item()}, whose chains agree least. "
        f"{capital(material.cite('sampling', 'posterior'))}.",
    )


def picture_bands(material: Material, *, early: bool) -> Picture | None:
    """Recordings against model, over all the time or the first second."""
    if "bands" not in material:
        return None
    bands = material.bands
    span = bands["quantile"].values[[0, -1]]
    share = format_percent(float(span[1] - span[0]))
    hidden = bands["protocol"].size - MOST_PROTOCOLS
    cut = f" The {MOST_PROTOCOLS} protocols of most trials are shown, {hidden} are not."
    n = int(bands["recorded_n"].max([d for d in bands["recorded_n"].dims if d != "protocol"]).sum())
    title = "the first second" if early else "all of it"
    return Picture(
        "bands_early" if early else "bands",
        f"Recordings against model: {title}",
        draw_bands(bands, EARLY if early else None),
        f"Predictive bands of the joint angle beside the recordings, {title}.",
        f"Blue: posterior predictive median and {share} equal-tailed interval for a new trial; "
        f"red, dashed: the same interval of the two-stage estimate; {DARK}: median and {share} "
        f"interval of the recordings. n = {count_things(n, 'trial')} in "
        f"{count_things(bands['protocol'].size, 'protocol')}.{cut if hidden > 0 else ''} "
        f"{capital(material.cite('bands'))}.",
    )


def picture_residuals(material: Material) -> Picture | None:
    """What the fit leaves."""
    residuals = material.residuals
    if residuals is None:
        return None
    rings = residuals["peak_frequency"].values
    rings = sorted({f"{ring:.1f} Hz" for ring in rings[np.isfinite(rings)]})
    seen = f" A ring of {join_words(rings)} stands out." if rings else ""
    n = int(residuals["n_segments"].sum())
    return Picture(
        "residuals",
        "What the model leaves",
        draw_residuals(residuals),
        "Mean of recording minus model over the time since the load changed, with the band that "
        f"chance would leave, and its spectrum.{seen}",
        "Left: recording minus model at each trial's posterior mean parameters, the mean over "
        f"n = {n} stretches after a change of load; grey: two standard errors about zero, what "
        "chance leaves. Motion outside the grey is shared by the trials and missing in the model. "
        "Right: the power of the residual times frequency; equal areas are equal variance, and a "
        f"narrow peak is a ring.{seen} {capital(material.cite('posterior', 'angles'))}.",
    )


def build_population(material: Material) -> xr.Dataset | None:
    """Build what the histograms draw: trials' estimates and fitted distributions."""
    if "least_squares" not in material:
        return None
    population = material.get("least_squares")
    if material.posterior is not None:
        population = population.assign(stack_population(material.posterior))
    return population


def picture_histograms(material: Material, *, initial: bool) -> Picture | None:
    """Histograms of the trials' estimates and the fitted densities."""
    population = build_population(material)
    if population is None:
        return None
    if initial:
        name, title, figure = (
            "initial_angles",
            "Initial angles",
            draw_initial_angles(population),
        )
        what = "initial angles"
    else:
        name, title = "histograms", "Distributions of the parameters over trials"
        figure = draw_parameter_histograms(population, material.load_unit)
        what = "viscoelastic parameters, on logarithmic axes"
    kept = population["kept"].sel(parameter=["q_ini"] if initial else ["k_v", "c_v", "c_p"])
    return Picture(
        name,
        title,
        figure,
        f"Histograms of the {what}, with the two-stage and the posterior density.",
        f"Bars: each trial's own least-squares estimate ({int((~kept).sum())} of {kept.size} "
        "dropped by the rule of three median absolute deviations, drawn open); red, dashed: the "
        "distribution fitted to the bars (two-stage); blue: the population by the posterior, "
        "median and 90 % equal-tailed interval. The bars are wider than the population where a "
        f"single trial knows little. n = {count_things(population['trial'].size, 'trial')}. "
        f"{capital(material.cite('least_squares', 'posterior'))}.",
    )


def picture_hyperparameters(material: Material) -> Picture | None:
    """Forest of the hyperparameters."""
    summary = material.hyperparameters
    if summary is None:
        return None
    share = format_percent(material.limits.ci_prob)
    beside = "; squares: the paper's table" if "paper" in summary else ""
    beside += "; diamonds: truth of the simulation" if "truth" in summary else ""
    return Picture(
        "hyperparameters",
        "Centre and spread of the population",
        draw_hyperparameters(summary),
        "Posterior intervals of centre and spread of every parameter at every joint.",
        f"Dots: posterior medians; thin lines: {share} equal-tailed intervals; thick lines: 50 %; "
        f"crosses: two-stage estimate{beside}. Of the natural logarithm, but for q_ini. "
        f"n = {count_things(material.angles['trial'].size, 'trial')}. "
        f"{capital(material.cite('posterior', 'least_squares'))}.",
    )


def picture_sobol(material: Material) -> Picture | None:
    """Sobol indices over time."""
    if "sobol" not in material:
        return None
    return Picture(
        "sobol",
        "Which parameter causes the spread",
        draw_sobol(select_sobol(material.get("sobol"))),
        "First-order Sobol indices of four parameters over time, all of it and the first second.",
        "Share of the variance between trials that each parameter causes alone (thick, by the "
        "posterior) and together with others (thin); bands: equal-tailed interval over the "
        "posterior's draws, 90 %. Below: the first second. The shares need not sum to 1: k_v and "
        f"c_v act together. {capital(material.cite('sobol'))}.",
    )


def picture_shapley(material: Material) -> Picture | None:
    """Shapley effects over time."""
    if "shapley" not in material:
        return None
    return Picture(
        "shapley",
        "The same where parameters go together",
        draw_shapley(material.get("shapley")),
        "Shapley effects of four parameters over time, one panel for each joint, with bands.",
        "Share of the variance between trials that each parameter gets if those that go together "
        "share what they cause together (Shapley effects); the shares sum to 1. Bands: equal-"
        f"tailed interval over the posterior's draws, 90 %. {capital(material.cite('shapley'))}.",
    )


def select_sobol(sobol: xr.Dataset) -> xr.Dataset:
    """Select the indices by the posterior, their quantiles under the names that are drawn."""
    chosen = sobol.sel(estimate="posterior") if "estimate" in sobol.dims else sobol
    for name in ("first_order", "total"):
        if f"{name}_quantile" in chosen:
            chosen = chosen.assign({name: chosen[f"{name}_quantile"]})
    return chosen


def picture_densities(material: Material) -> Picture | None:
    """Density of the joint angle over time."""
    if "densities" not in material:
        return None
    densities = material.get("densities").sel(estimate="posterior")
    shown = format_percent(float(densities["probability_shown"].min()))
    return Picture(
        "densities",
        "Density of the joint angle over time",
        draw_densities(densities),
        "Density of the joint angle at several times; its peak moves and widens.",
        "Density of the joint angle of a new trial at several times, each scaled to its own peak: "
        "it moves and widens. Lines: mean over the posterior's draws; within the bands lie 90 % of "
        f"the draws' densities (equal tails). At least {shown} of the probability lies within the "
        f"angles drawn. {capital(material.cite('densities'))}.",
    )
