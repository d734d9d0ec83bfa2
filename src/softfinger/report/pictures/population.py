"""The figures of the population's parameters."""

from softfinger.figures.hyperparameters import draw_hyperparameters
from softfinger.figures.population import draw_initial_angles, draw_parameter_histograms
from softfinger.report.blocks import Picture
from softfinger.report.formatting import capital, count_things, format_percent
from softfinger.report.material import Material


def picture_histograms(material: Material, *, initial: bool) -> Picture | None:
    """Histograms of the trials' estimates and the fitted densities."""
    histograms = material.find("histograms")
    if histograms is None:
        return None
    if initial:
        name, title, figure = (
            "initial_angles",
            "Initial angles",
            draw_initial_angles(histograms),
        )
        what = "initial angles"
    else:
        name, title = "histograms", "Distributions of the parameters over trials"
        figure = draw_parameter_histograms(histograms, material.load_unit)
        what = "viscoelastic parameters, on logarithmic axes"
    shown = histograms.sel(parameter=["q_ini"] if initial else ["k_v", "c_v", "c_p"])
    dropped, estimates = int(shown["dropped"].sum()), int(shown["estimates"].sum())
    return Picture(
        name,
        title,
        figure,
        f"Histograms of the {what}, with the two-stage and the posterior density.",
        f"Bars: each trial's own least-squares estimate ({dropped} of {estimates} "
        "dropped by the rule of three median absolute deviations, drawn open); red, dashed: the "
        "distribution fitted to the bars (two-stage); blue: the population by the posterior, "
        "median and 90 % equal-tailed interval. The bars are wider than the population where a "
        f"single trial knows little. n = {count_things(material.angles['trial'].size, 'trial')}. "
        f"{capital(material.cite('least_squares', 'posterior'))}.",
    )


def picture_hyperparameters(material: Material) -> Picture | None:
    """Forest of the hyperparameters."""
    summary = material.find("population")
    if summary is None:
        return None
    share = format_percent(material.ci_prob)
    rivals = summary["rival"].values if "rival" in summary.dims else ()
    beside = "; squares: the paper's table" if "paper" in rivals else ""
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
