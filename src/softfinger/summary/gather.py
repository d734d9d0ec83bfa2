"""Everything that figures and report show."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.summary import calibration, causes, checks, diagnosis, granted, population
from softfinger.summary.config import ReportConfig
from softfinger.summary.histograms import compute_histograms
from softfinger.summary.motion import compute_fitted_angle
from softfinger.summary.prior_predictive import compute_prior_predictive
from softfinger.summary.recordings import choose_frame, summarise_recordings, summarise_tracking
from softfinger.summary.residuals import summarise_residuals
from softfinger.summary.sampling import pick_worst_quantity

Artifacts = Mapping[str, Any]


def judge_run(
    artifacts: Artifacts,
    limits: ReportConfig,
    rng: np.random.Generator,
    move: Move = move_paper_joint,
    move_prior: Move = move_paper_joint,
) -> xr.DataTree:
    """Check computation, fit and calibration: the artifact `checks`.

    Parameters
    ----------
    artifacts
        By name; `angles` is needed.
    rng
        Draws new trials from the priors.
    move, move_prior
        The fitted model at its mean effects, and at the prior's draws of them.

    Returns
    -------
    DataTree
        Group `checks`, and each other group whose artifacts are there.
    """
    angles, tree = artifacts["angles"], artifacts.get("posterior")
    posterior = None if tree is None else tree["posterior"].dataset
    groups: dict[str, xr.Dataset] = {}
    if tree is not None:
        fitted = compute_fitted_angle(angles, posterior, move)
        left = summarise_residuals(angles, posterior, fitted)
        detectable = checks.measure_detectable(left, limits.shared_residual_max)
        groups["residuals"] = left.assign(detectable=((), detectable))
        if "prior" in tree.children:
            prior = tree["prior"].dataset
            groups["prior_predictive"] = compute_prior_predictive(prior, angles, rng, move_prior)
        groups |= {name: judge(tree[name].to_dataset()) for name, judge in JUDGED.items()
                   if name in tree.children and angles.sizes["trial"] > 1}  # fmt: skip
        if "prior_sensitivity" in tree.children:
            found = tree["prior_sensitivity"].to_dataset()
            groups["prior_sensitivity"] = granted.judge_prior_sensitivity(found)
        if "sampling" in artifacts:
            groups["sampling"] = pick_worst_quantity(artifacts["sampling"], posterior)
    if "bands" in artifacts:
        bands = artifacts["bands"]
        groups["calibration"] = calibration.summarise_calibration(bands, angles, limits.ci_prob)
    groups["checks"] = checks.gather_checks(
        [
            *checks.check_computation(None if tree is None else artifacts.get("sampling")),
            checks.check_pareto(tree, limits.pareto_k_max),
            *checks.check_fit(groups.get("residuals"), limits.shared_residual_max),
            *checks.check_calibration(
                groups.get("calibration"), angles.sizes["trial"], limits.coverage_tolerance
            ),
        ]
    )
    return _build_tree(groups)


JUDGED: dict[str, Callable[[xr.Dataset], xr.Dataset]] = {
    "independence": granted.list_doubtful_pairs,
    "loo_pit": granted.judge_loo_pit,
}
"""What only several trials can show."""


def summarise(
    artifacts: Artifacts, limits: ReportConfig, sentences: Mapping[str, str]
) -> xr.DataTree:
    """Sum up recordings, population and diagnosis: the artifact `summary`.

    Parameters
    ----------
    artifacts
        By name; `angles` is needed.
    sentences
        Effect → what happens.

    Returns
    -------
    DataTree
        Group `recordings`, and each other group whose artifacts are there.
    """
    angles = artifacts["angles"]
    groups = {"recordings": summarise_recordings(angles)}
    if "markers" in artifacts:
        groups["pictured"] = choose_frame(artifacts["markers"], artifacts.get("picture"))
    groups |= _summarise_fit(artifacts, limits)
    for name, (source, sum_up) in SUMMED.items():
        if source in artifacts:
            groups[name] = sum_up(artifacts[source])
    if "ranking" in artifacts:
        looked = artifacts["ranking"], artifacts.get("masking")
        groups["evidence"] = diagnosis.summarise_evidence(*looked, sentences)
    if "verdict" in artifacts:
        found = artifacts["verdict"], artifacts.get("location")
        groups["location"] = diagnosis.summarise_location(angles, *found)
    return _build_tree(groups)


SUMMED: dict[str, tuple[str, Callable[[xr.Dataset], xr.Dataset]]] = {
    "tracking": ("tracking_quality", summarise_tracking),
    "causes": ("sobol", causes.find_causes),
    "pairs": ("shapley", causes.find_pairs),
    "misfit": ("repair", diagnosis.summarise_misfit),
    "assumptions": ("assumptions", diagnosis.summarise_assumptions),
    "noise": ("measurement", diagnosis.summarise_measurement),
}
"""Group → the one artifact that it sums up, and how."""


def _summarise_fit(artifacts: Artifacts, limits: ReportConfig) -> dict[str, xr.Dataset]:
    least_squares, tree = artifacts.get("least_squares"), artifacts.get("posterior")
    groups, drawn = {}, None
    if tree is not None:
        posterior = tree["posterior"].dataset
        drawn = population.stack_population(posterior)
        paper = is_like_the_paper(artifacts["angles"])
        rivals = population.gather_rivals(least_squares, like_the_paper=paper)
        summed = population.summarise_population(posterior, limits.ci_prob, rivals)
        groups["population"] = summed
        if posterior.sizes.get("effect_parameter", 0):
            groups["effects"] = population.summarise_effects(posterior, limits.ci_prob)
        if "parameter_correlation" in posterior and artifacts["angles"].sizes["trial"] > 1:
            found = population.summarise_correlations(posterior, limits.ci_prob)
            groups["correlations"] = found
    if least_squares is not None:
        groups["histograms"] = compute_histograms(least_squares, drawn)
    return groups


def is_like_the_paper(angles: xr.Dataset) -> bool:
    """Whether the finger has the paper's parameters.

    Three joints under a torque give the paper's number and units.
    """
    kinds = set(angles["load_kind"].values.astype(str).tolist())
    return kinds <= {"tension_n", "torque_nm"} and angles.sizes["joint"] == 3


def _build_tree(groups: Mapping[str, xr.Dataset]) -> xr.DataTree:
    return xr.DataTree.from_dict({f"/{name}": group for name, group in groups.items()})
