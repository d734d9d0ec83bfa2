"""Draws in blocks, for campaigns of many trials.

With so many trials the steps of NUTS become short.

A sweep draws, each given the rest:

- every trial's parameters, all trials side by side and each accepted on its own: its standard
  normals z under the whitening (`whitening`) become α z + √(1 − α²) ξ, ξ ~ N(0, 1), which keeps
  N(0, 1); what the trial's density has beyond it decides (Neal 1998). α is 0, a draw afresh, and
  then more, which moves trials that the data leave long tails;
- effects φ by a random walk in their posterior's shape; the trials' z stay, so that their
  parameters follow;
- each population's log σ with μ integrated out, by slice sampling (Neal 2003), then μ, normal;
- the noise's scale by a random walk: given the trials' χ² it needs nothing else.

Where single trials show their own parameters, sweeps are nearly independent. Elsewhere, as
with a flow that is hardly seen, a population and its trials move slowly together. R-hat shows it,
and NUTS is the better sampler. Only for independent parameters; the density is the one that
`density` declares, and a test compares the two samplers.

References
----------
Neal (1998), doi:10.1007/978-94-011-5014-9_23 (section 4); Neal (2003), Ann. Statist. 31, 705,
doi:10.1214/aos/1056562461.
"""

from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from threading import Event

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.density import Given
from softfinger.inference.expansion import fill_squares
from softfinger.inference.gibbs_moves import draw_populations, step_trials
from softfinger.inference.whitening import colour_about, colour_trials, shift_pull, whiten_about
from softfinger.progress import follow_progress


@dataclass
class ChainState:
    """State of a chain.

    η (d, trial), χ² (trial,), μ and σ (d,), φ unbounded (p,), log s.
    """

    eta: NDArray[np.float64]
    square: NDArray[np.float64]
    mu: NDArray[np.float64]
    sigma: NDArray[np.float64]
    number: NDArray[np.float64]
    log_scale: float


def sample_gibbs(
    given: Given,
    sigma: NDArray[np.float64],
    rng: np.random.Generator,
    *,
    chains: int,
    tune: int,
    draws: int,
    cores: int,
) -> tuple[dict[str, NDArray[np.float64]], xr.Dataset]:
    """Draw from the posterior of a campaign.

    Parameters
    ----------
    given
        What the campaign and the model give.
    sigma
        (d,) of the population, about: where the chains start.
    chains, tune, draws, cores
        As usual; the sweeps before `draws` are forgotten, nothing is adapted.

    Returns
    -------
    variables, statistics
        mu, sigma, eta, effect, noise_scale (chain, draw, …); acceptance_rate (chain, draw) of the
        trials' moves, diverging: nothing can.
    """
    trials, size = given.expansion.own.shape
    shapes = {
        "mu": (size,), "sigma": (size,), "eta": (trials, size),
        "effect": (len(given.effects.names),), "noise_scale": (), "rate": (),
    }  # fmt: skip
    kept = {name: np.empty((chains, draws, *shape)) for name, shape in shapes.items()}
    done, stop = np.zeros(chains, int), Event()

    def run(chain: int, stream: np.random.Generator) -> None:
        state = start_chain(given, sigma, stream)
        for sweep in range(-tune, draws):
            rate = sweep_once(state, given, stream)
            done[chain] += 1
            if stop.is_set():
                return
            if sweep >= 0:
                for name, value in _read_state(state, given).items():
                    kept[name][chain, sweep] = value
                kept["rate"][chain, sweep] = rate

    with ThreadPoolExecutor(cores) as pool:
        running = [pool.submit(run, chain, each) for chain, each in enumerate(rng.spawn(chains))]
        _follow_chains(running, done, chains * (tune + draws), stop)
    rate = xr.DataArray(kept.pop("rate"), dims=("chain", "draw"))
    diverging = xr.zeros_like(rate, dtype=bool)
    return kept, xr.Dataset({"diverging": diverging, "acceptance_rate": rate})


def _read_state(state: ChainState, given: Given) -> dict[str, NDArray[np.float64]]:
    bounded = given.effects.bounded
    return {
        "mu": state.mu,
        "sigma": state.sigma,
        "eta": state.eta.T,
        "effect": bounded.bind(state.number),
        "noise_scale": np.exp(state.log_scale),
    }


def _follow_chains(running: list[Future], done: NDArray, sweeps: int, stop: Event) -> None:
    """Wait for all chains' sweeps, even after Ctrl-C."""
    try:
        with follow_progress("sampling chains", sweeps) as follow:
            while wait(running, timeout=0.1).not_done:
                follow(int(done.sum()))
        for each in running:
            each.result()
    finally:
        stop.set()


def start_chain(given: Given, sigma: NDArray[np.float64], rng: np.random.Generator) -> ChainState:
    """Start a chain, dispersed about population and fit."""
    expansion, bounded = given.expansion, given.effects.bounded
    trials, size = expansion.own.shape
    few = BUDGET.dispersion / np.sqrt(trials)
    sigma = sigma * np.exp(few / np.sqrt(2) * rng.standard_normal(size))
    mu = expansion.own.mean(axis=0) + few * sigma * rng.standard_normal(size)
    wide = BUDGET.dispersion * bounded.root
    number = bounded.centre + wide @ rng.standard_normal(len(bounded.low))
    state = ChainState(np.empty((size, trials)), np.empty(trials), mu, sigma, number, 0.0)
    normal = rng.standard_normal(state.eta.shape)
    state.eta[:] = colour_about(normal, *_place_trials(state, given, number))
    _measure(given, state.eta, number, state.square)
    return state


def _place_trials(
    state: ChainState, given: Given, number: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centre (d, trial), factor (d, d, trial) of whitening."""
    expansion, bounded = given.expansion, given.effects.bounded
    change = bounded.bind(number) - expansion.shared
    pull = shift_pull(expansion.pull, expansion.cross, change)
    precision = np.diag(state.sigma**-2.0)
    none = np.zeros(state.eta.shape)
    centre, _, factor = colour_trials(none, expansion.curvature, pull, state.mu, precision)
    return centre, factor


def _measure(
    given: Given, eta: NDArray, number: NDArray, square: NDArray[np.float64]
) -> NDArray[np.float64]:
    expansion, bounded = given.expansion, given.effects.bounded
    effect = bounded.bind(number)
    fill_squares(eta, effect, expansion.own, expansion.shared, expansion.gram, square)
    return square


def sweep_once(state: ChainState, given: Given, rng: np.random.Generator) -> float:
    """Draw everything once, in place; accepted share."""
    expansion, prior = given.expansion, given.prior
    bounded = given.effects.bounded
    accepted = 0
    for kept in BUDGET.gibbs_moves:
        accepted += step_trials(
            rng, kept, state.eta, state.square, (state.mu, state.sigma),
            _place_trials(state, given, state.number),
            bounded.bind(state.number), np.exp(state.log_scale),
            (expansion.own, expansion.shared, expansion.gram),
        )  # fmt: skip
    if len(state.number):
        _move_effects(state, given, rng)
    joints = len(state.mu) // len(prior.mu_mean)
    parts = (prior.mu_mean, prior.mu_sd, np.log(prior.sigma_median), prior.sigma_log_sd)
    known = tuple(np.tile(part, joints) for part in parts)
    state.mu, state.sigma = draw_populations(rng, state.eta, state.sigma, known)
    _move_scale(state, given, rng)
    return accepted / (len(BUDGET.gibbs_moves) * state.eta.shape[1])


def _move_effects(state: ChainState, given: Given, rng: np.random.Generator) -> None:
    """Walk φ; the trials' standard normals are fixed."""
    effects, bounded = given.effects, given.effects.bounded
    step = BUDGET.walk / np.sqrt(len(state.number)) * bounded.root
    number = state.number + step @ rng.standard_normal(len(state.number))
    here, there = (_place_trials(state, given, n) for n in (state.number, number))
    eta = colour_about(whiten_about(state.eta, *here), *there)
    square = _measure(given, eta, number, np.empty_like(state.square))

    def weigh(own: NDArray, squares: NDArray, unbounded: NDArray) -> float:
        away = (own - state.mu[:, None]) / state.sigma[:, None]
        effect = bounded.bind(unbounded)
        value = -0.5 * np.sum(((effect - effects.mean) / effects.sd) ** 2)
        value += np.sum(bounded.log_slope(unbounded))
        return value - 0.5 * (squares.sum() * np.exp(-2 * state.log_scale) + np.sum(away**2))

    gain = weigh(eta, square, number) - weigh(state.eta, state.square, state.number)
    if np.log(rng.random()) < gain:
        state.eta[:], state.square[:], state.number = eta, square, number


def _move_scale(state: ChainState, given: Given, rng: np.random.Generator) -> None:
    """Walk log s given the trials' χ²."""
    rows, total = given.expansion.rows.sum(), state.square.sum()
    spread = given.prior.noise_log_sd

    def weigh(log_scale: float) -> float:
        fit = -0.5 * total * np.exp(-2 * log_scale) - rows * log_scale
        return fit - 0.5 * (log_scale / spread) ** 2

    width = BUDGET.walk * (spread**-2.0 + 2 * rows) ** -0.5
    there = state.log_scale + width * rng.standard_normal()
    if np.log(rng.random()) < weigh(there) - weigh(state.log_scale):
        state.log_scale = there
