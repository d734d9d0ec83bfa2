"""The figures of the population's parameters."""

from __future__ import annotations

import xarray as xr

from softfinger.figures.hyperparameters import draw_hyperparameters
from softfinger.figures.population import draw_initial_angles, draw_parameter_histograms
from softfinger.report.blocks import Picture
from softfinger.report.formatting import capital, count_things, format_percent
from softfinger.report.material import Material
from softfinger.report.summaries import stack_population


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
