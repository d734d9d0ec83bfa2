"""NUTS by nutpie on a PyMC model.

PyTensor compiles its log density with numba, and caches it.

nutpie's own compilation of a PyMC model is redone in every process and takes long with many data
arrays, so PyTensor's compiled function is handed over as it is, free of Python's lock.
"""

from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
import nutpie
import pymc as pm
import pytensor
import pytensor.tensor as pt
import xarray as xr
from numba import njit
from numpy.typing import NDArray
from pymc.pytensorf import compile as compile_function
from pytensor.graph import rewrite_graph
from pytensor.graph.replace import graph_replace
from pytensor.link.numba.cache import CACHED_SRC_FUNCTIONS
from pytensor.tensor.variable import TensorVariable
from scipy.special import expit

from softfinger.inference.budget import BUDGET
from softfinger.inference.correlation import (
    Covariance,
    correlate_free_partials_array,
    invert_covariance_array,
)
from softfinger.inference.density import Given, gather_data, shift_mean
from softfinger.inference.whitening import colour_trials, place_mean, shift_pull
from softfinger.progress import follow_progress

LENGTHS = {"effect": "effect_mean", "mu": "mu_mean", "sigma": "mu_mean", "eta": "mu_mean"}
"""Variables and the data whose length is theirs."""
STATISTICS = ("diverging", "energy", "logp", "n_steps", "step_size", "tree_depth", "depth")


class Density(NamedTuple):
    """A compiled log density of the unconstrained point.

    The point (n,), the data, and the point's layout.
    """

    evaluate: Callable[..., tuple[NDArray, NDArray]]  # of the point and then the data
    data: dict[str, NDArray]  # in the order in which evaluate takes them
    shapes: dict[str, tuple[int, ...]]  # of the model's variables, in the order of the point

    @property
    def size(self) -> int:
        """Length of the point."""
        return sum(int(np.prod(shape)) for shape in self.shapes.values())

    def choose_data(self, given: Given) -> dict[str, NDArray]:
        """Choose the data that the density reads.

        `given` is what another campaign gives.
        """
        data = gather_data(given)
        return {name: data[name] for name in self.data}


def compile_density(model: pm.Model) -> Density:
    """Compile a log density and its slope.

    Parameters
    ----------
    model
        Any PyMC model without discrete variables.
    """
    start = model.initial_point()
    values = sorted(
        (model.rvs_to_values[rv] for rv in model.free_RVs), key=lambda v: start[v.name].ndim
    )
    # merged first, so that the whitening, which three terms share, is differentiated once
    log_density = rewrite_graph(model.logp(), include=("canonicalize", "stabilize"))
    slope = pt.concatenate([pt.grad(log_density, value).ravel() for value in values])
    point = pt.dvector("point")
    shapes = {model.values_to_rvs[v].name: start[v.name].shape for v in values}
    parts = _split(point, model, shapes)
    outputs = graph_replace([log_density, slope], dict(zip(values, parts, strict=True)))
    # leave to reorder sums would make the draws of a first, compiling run differ from later ones
    with model, pytensor.config.change_flags(numba__fastmath=False):
        compiled = compile_function([point], outputs, mode="NUMBA")
    data = {shared.name: shared.get_value() for shared in compiled.get_shared()}
    return Density(_release_lock(compiled.vm.jit_fn), data, shapes)


def _split(
    point: TensorVariable, model: pm.Model, shapes: Mapping[str, tuple[int, ...]]
) -> list[TensorVariable]:
    """Split a point into variables.

    Lengths that some data have stay open, and so does the last.

    The compiled code, and so its cache, then serves any number of trials, joints and effects.
    """
    parts, begin = [], 0
    for name, shape in shapes.items():
        known = [model[LENGTHS[name]].shape[0]] if name in LENGTHS else []
        if len(shape) > 1:  # the trials' parameters, which come last
            parts.append(point[begin:].reshape((known[0], -1)))
            continue
        lengths = known or list(shape)
        end = begin + (lengths[0] if lengths else 1)
        parts.append(point[begin:end].reshape(lengths))
        begin = end
    return parts


def _release_lock(function: Callable) -> Callable:
    """Make a compiled function's twin without Python's lock.

    Other threads can run beside it. It is cached like the first.
    """
    plain = function.py_func
    key = CACHED_SRC_FUNCTIONS.get(plain)
    twin = FunctionType(plain.__code__, plain.__globals__, plain.__name__, plain.__defaults__)
    if key is not None:
        CACHED_SRC_FUNCTIONS[twin] = f"{key}_nogil"
    return njit(nogil=True, cache=key is not None)(twin)


def expand_points(
    points: NDArray[np.float64],
    shapes: Mapping[str, tuple[int, ...]],
    given: Given,
    covariance: Covariance,
) -> dict[str, NDArray[np.float64]]:
    """Turn unconstrained points into the model's variables.

    From (chain, draw, n) to (chain, draw, …).

    Undoes PyMC's own transforms, the placing, the bounding and the whitening; partial correlations
    come back as such, from −1 to 1.
    """
    lead = points.shape[:2]
    ends = np.cumsum([int(np.prod(shape)) for shape in shapes.values()])
    parts = np.split(points, ends[:-1], axis=-1)
    raw = {
        name: part.reshape(*lead, *shape)
        for (name, shape), part in zip(shapes.items(), parts, strict=True)
    }
    expansion, bounded = given.expansion, given.effects.bounded
    joints = expansion.own.shape[1] // 4
    effect = bounded.bind(bounded.centre + raw["effect"] @ bounded.root.T)
    change = effect - expansion.shared
    variables = {"sigma": np.exp(raw["sigma"]), "eta": np.empty_like(raw["eta"]), "effect": effect}
    known = (np.tile(given.prior.mu_mean, joints), np.tile(given.prior.mu_sd, joints))
    centre, spread = place_mean(*known, variables["sigma"], given.value, given.variance)
    variables["mu"] = centre + change @ shift_mean(expansion).T + spread * raw["mu"]
    correlation = np.full(lead, None)
    if "parameter_partial" in raw:
        partial = 2 * expit(raw["parameter_partial"]) - 1
        correlation = correlate_free_partials_array(partial, joints, covariance)
        variables["parameter_correlation"] = correlation
    for at in np.ndindex(*lead):
        precision = invert_covariance_array(variables["sigma"][at], correlation[at])
        pull = shift_pull(expansion.pull, expansion.cross, change[at])
        stand_in = (expansion.curvature, pull)
        variables["eta"][at] = colour_trials(
            raw["eta"][at], *stand_in, variables["mu"][at], precision
        )[0]
    variables["eta"] = np.swapaxes(variables["eta"], -1, -2)
    variables["noise_scale"] = np.exp(raw["log_noise_scale"])
    return variables


def scale_points(
    shapes: Mapping[str, tuple[int, ...]], given: Given, sigma: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Find the posterior's centre and sd, about.

    Both are (n,), in every unconstrained direction.

    Parameters
    ----------
    given
        What the density was built from.
    sigma
        (d,) about, of the population.
    """
    trials = len(given.expansion.own)
    rows = max(given.expansion.rows.sum(), 1.0)
    places = {
        "sigma": (np.log(sigma), 1 / np.sqrt(2 * trials)),
        "log_noise_scale": (0.0, (given.prior.noise_log_sd**-2 + 2 * rows) ** -0.5),
        "parameter_partial": (0.0, min(2 / np.sqrt(trials), 1.0)),
    }
    usual = (0.0, 1.0)
    centre, spread = [], []
    for name, shape in shapes.items():
        at, width = places.get(name, usual)
        centre.append(np.broadcast_to(at, shape).ravel())
        spread.append(np.full(int(np.prod(shape)), width))
    return np.concatenate(centre), np.concatenate(spread)


def sample_density(
    density: Density,
    scale: tuple[NDArray[np.float64], NDArray[np.float64]],
    *,
    chains: int,
    tune: int,
    draws: int,
    cores: int,
    target_accept: float,
    max_depth: int,
    rng: np.random.Generator,
    data: Mapping[str, NDArray] | None = None,
) -> tuple[NDArray[np.float64], xr.Dataset]:
    """Draw from a density by NUTS.

    Parameters
    ----------
    scale
        Centre and sd (n,), about: the sampler's units, and where its chains start, dispersed.
    data
        Replaces the density's own data, all of the same rank.

    Returns
    -------
    points, statistics
        (chain, draw, n) and the sampler's statistics (chain, draw).
    """
    arrays = tuple((density.data if data is None else {**density.data, **data}).values())
    centre, spread = scale

    def log_density(x: NDArray) -> tuple[float, NDArray]:
        value, slope = density.evaluate(centre + spread * x, *arrays)
        return float(value), spread * slope

    def start(seed: int) -> NDArray[np.float64]:
        return BUDGET.dispersion * np.random.default_rng(seed).standard_normal(density.size)

    compiled = nutpie.compiled_pyfunc.from_pyfunc(
        density.size,
        lambda: log_density,
        lambda *_: lambda x: {"point": x},
        [np.dtype(float)],
        [(density.size,)],
        ["point"],
        dims={"point": ("value",)},
        coords={"value": np.arange(density.size)},
        make_initial_point_fn=start,
    )
    with follow_progress("sampling chains", chains * (tune + draws)) as follow:
        sampler = nutpie.sample(
            compiled, draws=draws, tune=tune, chains=chains, cores=cores,
            target_accept=target_accept, maxdepth=max_depth, initial_step=BUDGET.first_step,
            seed=int(rng.integers(2**31)), save_warmup=False, progress_bar=False,
            progress_callback=lambda each: follow(sum(chain.finished_draws for chain in each)),
            blocking=False,
        )  # fmt: skip
        trace = wait_for_draws(sampler)
    statistics = trace["sample_stats"].to_dataset()
    kept = [name for name in STATISTICS if name in statistics]
    return centre + spread * trace["posterior"]["point"].values, statistics[kept]


def wait_for_draws(sampler: Any) -> xr.DataTree:  # noqa: ANN401 (nutpie names no class)
    """Wait until a sampler has drawn all.

    nutpie's own waiting takes Ctrl-C for a wish to go on with the draws so far.
    """
    try:
        return sampler.wait()
    except BaseException:
        sampler.cancel()
        raise
