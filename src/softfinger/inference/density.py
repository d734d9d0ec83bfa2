"""The hierarchical model of any finger in PyMC.

It is a textbook population of trials, and effects:

    μ_jk ~ normal, log σ_jk ~ normal        (joint j; k = log k_v, log c_v, log c_p, q_ini)
    η_ijk ~ normal(μ_jk, σ_jk)              (trial i; independent, or correlated: LKJ(2))
    φ ~ normal within bounds                (effects; none in the paper's model)
    log s ~ normal                          (scale of the noise, about what was estimated)
    y_i ~ normal(F(η_i, φ), s² Σ_i)

The likelihood enters through `expansion`. The sampler sees η through `whitening` and φ through
`bounded`, so that its geometry is near a standard normal's. All data are `pm.Data`: compile once,
swap campaigns of the same size with `.with_data`.
"""

from typing import NamedTuple

import numpy as np
import pymc as pm
import pytensor.tensor as pt
from numpy.typing import NDArray
from pymc.logprob.transforms import Transform
from pytensor.graph.basic import Variable
from pytensor.tensor.variable import TensorVariable

from softfinger.inference.bounded import Bounded, bind, log_slope
from softfinger.inference.correlation import (
    Covariance,
    mark_free_partials,
    shape_free_partials,
)
from softfinger.inference.expansion import Expansion
from softfinger.inference.operations import ExpandedLikelihood, FactorisePartials, Multiply
from softfinger.inference.priors import PopulationPrior
from softfinger.inference.whitening import place_mean
from softfinger.inference.whitening_operations import ColourTrials, ShiftPull
from softfinger.mechanics import LOG_PARAMETERS


class Effects(NamedTuple):
    """Names, internal prior and bounds of φ (p,)."""

    names: list[str]
    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    bounded: Bounded


class Given(NamedTuple):
    """What a campaign and a model give the density.

    `value` and `variance` (p, trial): what each trial by itself shows of its own parameters.
    """

    expansion: Expansion
    prior: PopulationPrior
    effects: Effects
    value: NDArray[np.float64]
    variance: NDArray[np.float64]


class WhitenedSpace(Transform):
    """The trials' parameters as standard normals (`whitening`).

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
    """μ in units of its spread about its centre.

    It is given σ and φ (`whitening`).

    The inputs of the distribution end in prior mean and sd, σ (p,), value and variance (p, trial),
    and the shift of the centre that φ makes (p,).
    """

    name = "placed"
    ndim_supp = 1

    def backward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """μ from a standard normal."""
        centre, spread = place_mean(*inputs[-6:-1])
        return centre + inputs[-1] + spread * value

    def forward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """A standard normal from μ."""
        centre, spread = place_mean(*inputs[-6:-1])
        return (value - centre - inputs[-1]) / spread

    def log_jac_det(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Log volume."""
        return pt.sum(pt.log(place_mean(*inputs[-6:-1])[1]))


class Bounding(Transform):
    """Effects as standard normals, about (`bounded`).

    The inputs of the distribution end in low, high, scale, centre (p,) and root (p, p).
    """

    name = "bound"
    ndim_supp = 1

    def backward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Effects from standard normals."""
        *bounds, centre, root = inputs[-5:]
        return bind(centre + pt.dot(root, value), *bounds, pt)

    def forward(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Standard normals: the centre, for the starting point."""
        return pt.zeros_like(value)

    def log_jac_det(self, value: Variable, *inputs: Variable) -> TensorVariable:
        """Log volume."""
        *bounds, centre, root = inputs[-5:]
        slopes = log_slope(centre + pt.dot(root, value), *bounds, pt)
        return pt.sum(slopes) + pt.sum(pt.log(pt.diag(root)))


def _effect_logp(phi: Variable, mean: Variable, sd: Variable, *_: Variable) -> TensorVariable:
    """Independent normals within bounds; the rest serves the bounding."""
    return pt.sum(pm.logp(pm.Normal.dist(mean, sd), phi))


def _draw_effect(
    mean: NDArray,
    sd: NDArray,
    low: NDArray,
    high: NDArray,
    *_: NDArray,
    rng: np.random.Generator,
    size: object,
) -> NDArray:
    return np.clip(rng.normal(mean, sd), low, high)


def _mean_logp(mu: Variable, mean: Variable, sd: Variable, *_: Variable) -> TensorVariable:
    """Independent normals; the rest serves the placing only."""
    return pt.sum(pm.logp(pm.Normal.dist(mean, sd), mu))


def _draw_mean(
    mean: NDArray,
    sd: NDArray,
    sigma: NDArray,
    value: NDArray,
    variance: NDArray,
    shift: NDArray,
    rng: np.random.Generator,
    size: object,
) -> NDArray:
    return rng.normal(mean, sd)


def _population_logp(
    eta: Variable, mean: Variable, root: Variable, curvature: Variable, pull: Variable
) -> TensorVariable:
    """Normal, precision AᵀA; the rest serves the whitening."""
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


def build_pymc_model(
    given: Given, coords: dict, covariance: Covariance = "independent"
) -> pm.Model:
    """Build the hierarchical model.

    Parameters
    ----------
    given
        What the campaign and the model give.
    coords
        Names of trial and joint.
    covariance
        Which parameters of a trial may be correlated over trials.
    """
    joints = len(coords["joint"])
    own = [f"{name}[{joint}]" for joint in coords["joint"] for name in LOG_PARAMETERS]
    labels = {**coords, "own": own, "effect_parameter": given.effects.names}
    with pm.Model(coords=labels) as model:
        data = {name: pm.Data(name, value) for name, value in gather_data(given).items()}
        phi = pm.CustomDist(
            "effect", *(data[f"effect_{name}"] for name in ("mean", "sd", *Bounded._fields)),
            logp=_effect_logp, random=_draw_effect, signature="(e),(e),(e),(e),(e),(e),(e,e)->(e)",
            transform=Bounding(), dims="effect_parameter",
        )  # fmt: skip
        change = phi - data["shared"]
        sigma = pm.LogNormal("sigma", data["log_sigma"], data["sigma_log_sd"], dims="own")
        mu = pm.CustomDist(
            "mu", data["mu_mean"], data["mu_sd"], sigma, data["value"], data["variance"],
            pt.sum(data["mu_shift"] * change, axis=1),
            logp=_mean_logp, random=_draw_mean, signature="(p),(p),(p),(p,n),(p,n),(p)->(p)",
            transform=Placing(), dims="own",
        )  # fmt: skip
        eta = pm.CustomDist(
            "eta", mu, _root_precision(sigma, joints, covariance), data["curvature"],
            ShiftPull()(data["pull"], data["cross"], change),
            logp=_population_logp, random=_draw_population,
            signature="(p),(p,p),(p,p,n),(p,n)->(p,n)",
            transform=WhitenedSpace(), dims=("own", "trial"),
        )  # fmt: skip
        log_scale = pm.Normal("log_noise_scale", 0.0, data["noise_log_sd"])
        likelihood = ExpandedLikelihood()(
            eta, phi, log_scale, *(data[name] for name in ("modes", "shared", "gram", "rows"))
        )[0]
        pm.Potential("log_likelihood", likelihood)
    return model


def _root_precision(sigma: Variable, joints: int, covariance: Covariance) -> TensorVariable:
    """Lower triangular A (p, p) of a trial's precision."""
    if covariance == "independent":
        return pt.diag(1 / sigma)
    free = mark_free_partials(joints, covariance)
    shape = shape_free_partials(joints, covariance)
    drawn = 2 * pm.Beta("parameter_partial", shape, shape) - 1
    partial = pt.set_subtensor(pt.zeros(len(free))[np.flatnonzero(free)], drawn)
    return pt.linalg.solve_triangular(FactorisePartials()(partial), pt.diag(1 / sigma), lower=True)


def gather_data(given: Given) -> dict[str, NDArray]:
    """Gather the model's data that another campaign replaces."""
    expansion, prior, effects = given.expansion, given.prior, given.effects
    joints = expansion.own.shape[1] // len(LOG_PARAMETERS)
    tiled = {
        "mu_mean": prior.mu_mean,
        "mu_sd": prior.mu_sd,
        "log_sigma": np.log(prior.sigma_median),
        "sigma_log_sd": prior.sigma_log_sd,
    }
    data = {
        "modes": expansion.own,
        "shared": expansion.shared,
        "gram": expansion.gram,
        "rows": expansion.rows,
        "curvature": expansion.curvature,
        "pull": expansion.pull,
        "cross": expansion.cross,
        "value": given.value,
        "variance": given.variance,
        "mu_shift": shift_mean(expansion),
        "noise_log_sd": prior.noise_log_sd,
        "effect_mean": effects.mean,
        "effect_sd": effects.sd,
        **{f"effect_{name}": value for name, value in effects.bounded._asdict().items()},
        **{name: np.tile(value, joints) for name, value in tiled.items()},
    }
    return {name: np.array(value, float, order="C") for name, value in data.items()}


def shift_mean(expansion: Expansion) -> NDArray[np.float64]:
    """How μ depends on φ (d, p).

    In the linearised posterior it is Cov(μ, φ) Cov(φ)⁻¹.
    """
    d = expansion.own.shape[1]
    covariance = expansion.shared_covariance
    return np.linalg.solve(covariance[d:, d:], covariance[d:, :d]).T
