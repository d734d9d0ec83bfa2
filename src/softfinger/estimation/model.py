"""The hierarchical model in PyMC: a textbook population of trials with a collapsed likelihood.

    μ_jk ~ normal, log σ_jk ~ normal        (joint j; k = log k_v, log c_v, log c_p, q_ini)
    η_ijk ~ normal(μ_jk, σ_jk)              (trial i; independent, or correlated: LKJ(2))
    y_i ~ normal(q(t; η_i), AR(1) noise: sd s_j, autocorrelation ρ_j, joints' correlation C)

The likelihood of all frames enters through `population.collapse`, exactly. The sampler sees η
through `population.whitening`, so that its geometry is near a standard normal's. All data are
`pm.Data`: compile once, swap campaigns of the same size with `.with_data`.
"""

import numpy as np
import pymc as pm
import pytensor.tensor as pt
from numpy.typing import NDArray
from pymc.logprob.transforms import Transform
from pytensor.graph.basic import Variable
from pytensor.tensor.variable import TensorVariable

from softfinger.estimation.operations import (
    CollapsedLikelihood,
    ColourTrials,
    FactorisePartials,
    Multiply,
)
from softfinger.population.correlation import (
    Covariance,
    mark_free_partials,
    shape_free_partials,
    shape_partials,
)
from softfinger.population.likelihood import PARAMETERS
from softfinger.population.pilot import Pilot, count_patterns
from softfinger.population.priors import Prior
from softfinger.population.whitening import place_mean
from softfinger.population.windows import LocalCollapse


class Whitening(Transform):
    """The trials' parameters seen as standard normals, given the population (`whitening`).

    The inputs of the distribution end in mean (p,), root (p, p) of the precision, curvature
    (p, p, trial), pull (p, trial).
    """

    name = "whitened"
    ndim_supp = 2

    def _colour(self, z: Variable, inputs: tuple[Variable, ...]) -> list[Variable]:
        mean, root, curvature, pull = inputs[-4:]
        return ColourTrials()(z, curvature, pull, mean, Multiply()(root.T, root))

    def backward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Parameters from standard normals."""
        return self._colour(value, inputs)[0]

    def forward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Standard normals from parameters."""
        eta, _, factor = self._colour(pt.zeros_like(value), inputs)
        return pt.sum(factor * (value - eta)[:, None], axis=0)

    def log_jac_det(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Log volume of all trials."""
        return pt.sum(self._colour(value, inputs)[1])


class Placing(Transform):
    """μ in units of its spread about its centre, both given σ (`population.whitening`).

    The inputs of the distribution end in prior mean and sd, σ (p,), value and variance (p, trial).
    """

    name = "placed"
    ndim_supp = 1

    def backward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """μ from a standard normal."""
        centre, spread = place_mean(*inputs[-5:])
        return centre + spread * value

    def forward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """A standard normal from μ."""
        centre, spread = place_mean(*inputs[-5:])
        return (value - centre) / spread

    def log_jac_det(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Log volume."""
        return pt.sum(pt.log(place_mean(*inputs[-5:])[1]))


class Unbounding(Transform):
    """Autocorrelation ρ in (0, 1) as a number z: −log(1 − ρ) = s log(1 + eᶻ).

    With s half of the sd that ρ has near 0, a ρ that may be 0 is nearly normal in z, as one well
    away from 0 is; log ρ, and so its logit, would have a long tail towards 0.
    The input of the distribution is s.
    """

    name = "unbounded"

    def backward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """ρ from z."""
        return -pt.expm1(-inputs[-1] * pt.softplus(value))

    def forward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Z from ρ."""
        ratio = -pt.log1p(-value) / inputs[-1]
        return ratio + pt.log(-pt.expm1(-ratio))

    def log_jac_det(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Log of dρ/dz."""
        s = inputs[-1]
        return pt.log(s) - pt.softplus(-value) - s * pt.softplus(value)


def _uniform_logp(rho: Variable, _: Variable) -> TensorVariable:
    """Uniform on (0, 1); the resolution serves the unbounding only."""
    return pt.zeros_like(rho)


def _draw_uniform(_: NDArray, rng: np.random.Generator, size: object) -> NDArray:
    return rng.uniform(size=size)


def _mean_logp(mu: Variable, mean: Variable, sd: Variable, *_: Variable) -> TensorVariable:
    """Independent normals; σ and what the trials say serve the placing only."""
    return pt.sum(pm.logp(pm.Normal.dist(mean, sd), mu))


def _draw_mean(
    mean: NDArray,
    sd: NDArray,
    sigma: NDArray,
    value: NDArray,
    variance: NDArray,
    rng: np.random.Generator,
    size: object,
) -> NDArray:
    return rng.normal(mean, sd)


def _population_logp(
    eta: Variable, mean: Variable, root: Variable, curvature: Variable, pull: Variable
) -> TensorVariable:
    """Normal, of precision AᵀA; the likelihood's stand-in serves the whitening only."""
    z = Multiply()(root, eta - mean[:, None])
    volume = pt.log(pt.diag(root)).sum() - 0.5 * np.log(2 * np.pi) * root.shape[0]
    return volume * eta.shape[1] - 0.5 * pt.sum(z**2)


def _draw_population(
    mean: NDArray,
    root: NDArray,
    curvature: NDArray,
    pull: NDArray,
    rng: np.random.Generator,
    size: object,
) -> NDArray:
    return mean[:, None] + np.linalg.solve(root, rng.standard_normal(np.shape(pull)))


def build_model(
    collapse: LocalCollapse,
    prior: Prior,
    pilot: Pilot,
    coords: dict,
    covariance: Covariance = "independent",
) -> pm.Model:
    """Build the hierarchical model.

    Parameters
    ----------
    collapse, prior, pilot
        What `localise_collapse`, `build_prior` and `fit_pilot` make.
    coords
        Names of trial and joint.
    covariance
        Which parameters of a trial may go together over trials.
    """
    joints = collapse.present.shape[1]
    own = [f"{name}[{joint}]" for joint in coords["joint"] for name in PARAMETERS]
    with pm.Model(coords={**coords, "own": own}) as model:
        data = {name: pm.Data(name, value) for name, value in gather_data(collapse, pilot).items()}
        tiled = _tile_prior(prior, joints)
        given = {name: pm.Data(f"prior_{name}", value) for name, value in tiled.items()}
        sigma = pm.LogNormal("sigma", given["log_sigma"], given["sigma_log_sd"], dims="own")
        mu = pm.CustomDist(
            "mu", given["mu_mean"], given["mu_sd"], sigma, data["value"], data["variance"],
            logp=_mean_logp, random=_draw_mean, signature="(p),(p),(p),(p,n),(p,n)->(p)",
            transform=Placing(), dims="own",
        )  # fmt: skip
        eta = pm.CustomDist(
            "eta", mu, _root_precision(sigma, joints, covariance), data["curvature"], data["pull"],
            logp=_population_logp, random=_draw_population,
            signature="(p),(p,p),(p,p,n),(p,n)->(p,n)",
            transform=Whitening(), dims=("own", "trial"),
        )  # fmt: skip
        sd = pm.LogNormal("noise_sd", given["log_noise"], given["noise_log_sd"], dims="joint")
        rho = pm.CustomDist(
            "noise_autocorrelation", data["resolution"], logp=_uniform_logp, random=_draw_uniform,
            signature="()->()", transform=Unbounding(), dims="joint",
        )  # fmt: skip
        partial = _draw_partials(joints) if joints > 1 else np.empty(0)
        likelihood = CollapsedLikelihood()(
            eta.T.reshape((-1, joints, len(PARAMETERS))), sd, rho, partial,
            *(data[name] for name in LIKELIHOOD_DATA),
        )[0]  # fmt: skip
        pm.Potential("log_likelihood", likelihood + data["offset"])
    return model


LIKELIHOOD_DATA = (
    "place", "begin", "modes", "table_value", "table_slope", "window", "products", "first_row",
    "pattern", "patterns", "gap", "total",
)  # fmt: skip


def _draw_partials(joints: int) -> TensorVariable:
    """Partial correlations of the joints' noise whose correlation matrix is LKJ(2)."""
    shape = shape_partials(joints)
    return 2 * pm.Beta("noise_partial", shape, shape) - 1


def _root_precision(sigma: Variable, joints: int, covariance: Covariance) -> TensorVariable:
    """Lower triangular A (p, p) of the precision AᵀA of a trial's parameters."""
    if covariance == "independent":
        return pt.diag(1 / sigma)
    free = mark_free_partials(joints, covariance)
    shape = shape_free_partials(joints, covariance)
    drawn = 2 * pm.Beta("parameter_partial", shape, shape) - 1
    partial = pt.set_subtensor(pt.zeros(len(free))[np.flatnonzero(free)], drawn)
    return pt.linalg.solve_triangular(FactorisePartials()(partial), pt.diag(1 / sigma), lower=True)


def gather_data(collapse: LocalCollapse, pilot: Pilot) -> dict[str, NDArray]:
    """Gather everything that the compiled model reads and that another campaign replaces."""
    data = {
        "place": collapse.windows.place,
        "begin": collapse.windows.begin,
        "modes": collapse.windows.modes,
        "table_value": collapse.windows.value,
        "table_slope": collapse.windows.slope,
        "window": collapse.window,
        "products": collapse.products,
        "first_row": collapse.first,
        "pattern": collapse.pattern,
        "patterns": collapse.patterns,
        "gap": collapse.gap,
        "total": count_patterns(collapse),
        "offset": collapse.offset.sum(),
        "resolution": resolve_autocorrelation(collapse),
        "curvature": np.moveaxis(pilot.modes.curvature, 0, -1),
        "pull": pilot.modes.pull.T,
        "value": pilot.value.T,
        "variance": pilot.variance.T,
    }
    return {name: _store(value) for name, value in data.items()}


def _store(value: NDArray | float) -> NDArray:
    """Keep a copy row by row, whole numbers as PyMC keeps them."""
    array = np.array(value, order="C")
    return array.astype(np.int32) if array.dtype == np.int64 else array


def resolve_autocorrelation(collapse: LocalCollapse) -> float:
    """Half of the sd that so many frames leave of an autocorrelation near 0."""
    return 0.5 / np.sqrt(max(collapse.count[:, :-1].sum(), 1.0))


def _tile_prior(prior: Prior, joints: int) -> dict[str, NDArray]:
    return {
        "mu_mean": np.tile(prior.mu_mean, joints),
        "mu_sd": np.tile(prior.mu_sd, joints),
        "log_sigma": np.tile(np.log(prior.sigma_median), joints),
        "sigma_log_sd": np.tile(prior.sigma_log_sd, joints),
        "log_noise": np.asarray(np.log(prior.noise_median)),
        "noise_log_sd": np.asarray(prior.noise_log_sd),
    }
