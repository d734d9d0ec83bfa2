"""Draws in blocks, for campaigns of so many trials that the steps of NUTS become short.

A sweep draws, each given the rest:

- every trial's parameters, all trials side by side and each accepted on its own: its standard
  normals z under the whitening (`population.whitening`) become α z + √(1 − α²) ξ, ξ ~ N(0, 1),
  which keeps N(0, 1); what the trial's density has beyond it decides (Neal 1998). α is 0, a draw
  afresh, and then more, which moves trials that the data leave long tails;
- each population's log σ with μ integrated out, by slice sampling (Neal 2003), then μ, normal;
- the noise, number by number, by slice sampling: given the trials' parameters it needs nothing of
  the recordings but a few sums.

Every other sweep mirrors what the one before it drew, each block about its middle (α = −1 for the
trials; the noise's autocorrelation, which may lie at its bound, is drawn): two such draws err to
opposite sides, so that means take far fewer of them, and tails somewhat more (Hammersley, Morton
1956). A mirror image that is less probable may be refused, as any Metropolis step.

Where single trials tell their own parameters, pairs of sweeps are nearly independent. Where they do
not, as with a flow that is hardly seen, a population and its trials hold each other fast: R-hat
shows it, and NUTS is the better sampler. Only for independent parameters; the density is the one
that `estimation.model` declares, and a test holds the two samplers against each other.

References
----------
Neal (1998), doi:10.1007/978-94-011-5014-9_23 (section 4); Neal (2003), Ann. Statist. 31, 705,
doi:10.1214/aos/1056562461. Hammersley, Morton (1956), doi:10.1017/S0305004100031455.
"""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from threading import Event
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, logit

from softfinger.estimation.block_moves import (
    draw_noise,
    draw_populations,
    mirror_noise,
    mirror_populations,
    move_trials,
    read_noise,
    weigh_noise_point,
)
from softfinger.population.correlation import shape_partials
from softfinger.population.covariance import factorise_partials, find_partials_array
from softfinger.population.likelihood import PARAMETERS, fill_trial_sums
from softfinger.population.pilot import Pilot, count_patterns
from softfinger.population.priors import Prior
from softfinger.population.weights import weigh_noise
from softfinger.population.whitening import colour_trials
from softfinger.population.windows import LocalCollapse
from softfinger.progress import follow_progress

DISPERSION = 2.0  # of the starts, in approximate posterior standard deviations
AFRESH, MIRRORED = (0.0, 0.92), (-1.0,)  # α of the trials' moves in a sweep
CYCLE = (AFRESH, MIRRORED, AFRESH[:1], MIRRORED)  # of sweeps, once the chains have settled
NOISE_ROUNDS = 2  # of slices in a sweep: sd and autocorrelation go together


class Given(NamedTuple):
    """What no sweep changes, as the moves read it."""

    collapse: LocalCollapse
    recordings: tuple  # windows, window, products, first row
    stand_in: tuple[NDArray, NDArray]  # the likelihood's: curvature (p, p, trial), pull (p, trial)
    population: tuple[NDArray, ...]  # priors of μ and log σ: mean, sd, mean, sd, each (p,)
    noise: tuple  # of `weigh_noise_point`
    width: NDArray[np.float64]  # about, of the posterior of each of the noise's numbers


@dataclass
class State:
    """Where a chain is."""

    mu: NDArray[np.float64]  # (p,)
    sigma: NDArray[np.float64]  # (p,)
    eta: NDArray[np.float64]  # (p, trial)
    sums: NDArray[np.float64]  # of `fill_trial_sums`
    first_sums: NDArray[np.float64]
    noise: NDArray[np.float64]  # log σ, logit ρ (joint,), atanh of partial correlations (pair,)


def sample_blocks(
    collapse: LocalCollapse,
    prior: Prior,
    pilot: Pilot,
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
    collapse, prior, pilot
        What `localise_collapse`, `build_prior` and `fit_pilot` make.
    rng
        Gives each chain its own stream.
    chains, tune, draws, cores
        As usual; the sweeps before `draws` are forgotten, nothing is adapted.

    Returns
    -------
    variables, statistics
        mu, sigma, noise_… and eta (chain, draw, …); acceptance_rate (chain, draw) of the trials'
        moves, diverging: nothing can.
    """
    given = gather_given(collapse, prior, pilot)
    trials, joints = collapse.window.shape
    size, numbers = len(PARAMETERS) * joints, len(given.width)
    kept = {
        name: np.empty((chains, draws, *shape))  # filled by the chains: no copy of so much
        for name, shape in {
            "mu": (size,), "sigma": (size,), "eta": (trials, size), "noise": (numbers,), "rate": (),
        }.items()
    }  # fmt: skip
    done, stop = np.zeros(chains, int), Event()

    def run(chain: int, stream: np.random.Generator) -> None:
        def keep(sweep: int, state: State, rate: float) -> bool:
            done[chain] += 1
            if sweep >= 0:
                kept["mu"][chain, sweep], kept["sigma"][chain, sweep] = state.mu, state.sigma
                kept["eta"][chain, sweep], kept["noise"][chain, sweep] = state.eta.T, state.noise
                kept["rate"][chain, sweep] = rate
            return not stop.is_set()

        run_chain(given, pilot, stream, range(-tune, draws), keep)

    with ThreadPoolExecutor(cores) as pool:
        running = [pool.submit(run, chain, each) for chain, each in enumerate(rng.spawn(chains))]
        _follow_chains(running, done, chains * (tune + draws), stop)
    rate = xr.DataArray(kept.pop("rate"), dims=("chain", "draw"))
    sd, rho, partials = np.split(kept.pop("noise"), [joints, 2 * joints], axis=-1)
    noise = {"noise_sd": np.exp(sd), "noise_autocorrelation": expit(rho)}
    noise["noise_partial"] = np.tanh(partials)
    diverging = xr.zeros_like(rate, dtype=bool)
    return kept | noise, xr.Dataset({"diverging": diverging, "acceptance_rate": rate})


def _follow_chains(running: list[Future], done: NDArray, sweeps: int, stop: Event) -> None:
    """Wait for all chains; after Ctrl-C they end with the sweep that they are in."""
    try:
        with follow_progress("sampling chains", sweeps) as follow:
            while wait(running, timeout=0.1).not_done:
                follow(int(done.sum()))
        for each in running:
            each.result()
    finally:
        stop.set()


def gather_given(collapse: LocalCollapse, prior: Prior, pilot: Pilot) -> Given:
    """Gather what all chains share."""
    joints = collapse.window.shape[1]
    priors = (prior.mu_mean, prior.mu_sd, np.log(prior.sigma_median), prior.sigma_log_sd)
    curvature = np.ascontiguousarray(np.moveaxis(pilot.modes.curvature, 0, -1))
    noise = (
        collapse.gap, collapse.patterns, count_patterns(collapse),
        float(np.log(prior.noise_median)), float(prior.noise_log_sd),
        shape_partials(joints) if joints > 1 else np.empty(0),
    )  # fmt: skip
    return Given(
        collapse,
        (collapse.windows, collapse.window, collapse.products, collapse.first),
        (curvature, np.ascontiguousarray(pilot.modes.pull.T)),
        tuple(np.tile(part, joints) for part in priors),
        noise,
        _place_noise(pilot, collapse)[1],
    )


def start_chain(given: Given, pilot: Pilot, rng: np.random.Generator) -> State:
    """Start dispersed; each trial where its population and the pilot fit put it, about."""
    trials, joints = given.collapse.window.shape
    size = len(PARAMETERS) * joints
    point, width = _place_noise(pilot, given.collapse)
    noise = point + DISPERSION * width * rng.standard_normal(point.size)
    few = DISPERSION / np.sqrt(trials)
    sigma = pilot.sigma.ravel() * np.exp(few / np.sqrt(2) * rng.standard_normal(size))
    mu = pilot.mu.ravel() + few * sigma * rng.standard_normal(size)
    normal = rng.standard_normal((size, trials))
    eta = colour_trials(normal, *given.stand_in, mu, np.diag(1 / sigma**2))[0]
    sums = np.empty((trials, len(given.collapse.gap), 3, joints, joints))
    first_sums = np.empty((trials, joints, joints))
    by_trial = np.ascontiguousarray(eta.T).reshape(trials, joints, len(PARAMETERS))
    fill_trial_sums(by_trial, *given.recordings, sums, first_sums)
    return State(mu, sigma, eta, sums, first_sums, noise)


def run_chain(
    given: Given,
    pilot: Pilot,
    rng: np.random.Generator,
    sweeps: range,
    keep: Callable[[int, State, float], bool],
) -> None:
    """Sweep, and hand every state on with the share of moves that were accepted.

    Ends where `keep` says False.
    """
    state = start_chain(given, pilot, rng)
    middle = None
    for sweep in sweeps:
        if sweep == 0:
            middle = find_noise_middle(state, given)
        moves = AFRESH if sweep < 0 else CYCLE[sweep % len(CYCLE)]
        if not keep(sweep, state, sweep_once(state, given, rng, moves, middle)):
            return


def find_noise_middle(state: State, given: Given) -> NDArray[np.float64]:
    """Find the noise's most probable numbers, the trials' parameters being what they are."""
    totals = _sum_patterns(state, given.collapse)
    width = given.width

    def measure(moved: NDArray) -> float:
        return -weigh_noise_point(state.noise + width * moved, *totals, given.noise)

    # Not BFGS: where its line search ends for want of digits, it warns, and what it does to
    # silence that (`warnings.catch_warnings`) does not hold where chains run in threads.
    with np.errstate(invalid="ignore", over="ignore"):  # a step may leave the noise's range
        moved = minimize(measure, np.zeros(len(width)), method="L-BFGS-B").x
    return state.noise + width * moved


def sweep_once(
    state: State,
    given: Given,
    rng: np.random.Generator,
    moves: tuple[float, ...],
    middle: NDArray[np.float64] | None,
) -> float:
    """Draw or mirror everything once, in place: the share of the trials' moves that were accepted.

    `middle` is that of the noise's numbers; None while nothing is mirrored.
    """
    collapse, joints = given.collapse, given.collapse.window.shape[1]
    sd, rho, partials = read_noise(state.noise, joints)
    factor = factorise_partials(partials)
    weights = weigh_noise(collapse.gap, collapse.patterns, sd, rho, factor @ factor.T)
    weighing = (weights.pair, np.ascontiguousarray(weights.precision[:, -1]))
    numbers, accepted = np.arange(len(state.noise)), 0
    for kept in moves:
        accepted += move_trials(
            rng, kept, state.eta, state.sums, state.first_sums, (state.mu, state.sigma),
            given.stand_in, weighing, collapse.pattern, given.recordings,
        )  # fmt: skip
    totals = _sum_patterns(state, collapse)
    if moves != MIRRORED:
        state.mu, state.sigma = draw_populations(rng, state.eta, state.sigma, given.population)
        draw_noise(
            rng, np.tile(numbers, NOISE_ROUNDS), state.noise, 3 * given.width, *totals, given.noise
        )
    else:
        state.mu, state.sigma = mirror_populations(
            rng, state.eta, state.mu, state.sigma, given.population
        )
        bounded = (joints <= numbers) & (numbers < 2 * joints)  # ρ: near 0 there is no mirror image
        mirror_noise(rng, numbers[~bounded], state.noise, middle, *totals, given.noise)
        draw_noise(rng, numbers[bounded], state.noise, 3 * given.width, *totals, given.noise)
    return accepted / (len(moves) * state.eta.shape[1])


def _place_noise(pilot: Pilot, collapse: LocalCollapse) -> tuple[NDArray, NDArray]:
    """Find where the noise's numbers lie, and about how surely."""
    sd, rho, correlation = pilot.noise
    frames = max(float(collapse.count[:, :-1].sum()), 2.0)
    # nothing says that ρ is not 0 where it is within the sd that so many frames leave
    rho = np.clip(rho, 1 / np.sqrt(frames), 1 - 1e-6)
    partials = find_partials_array(correlation)
    point = np.concatenate([np.log(sd), logit(rho), np.arctanh(partials)])
    width = [
        np.sqrt((1 + rho**2) / (1 - rho**2) / (2 * frames)),
        np.sqrt((1 - rho**2) / frames) / (rho * (1 - rho)),
        np.full(len(partials), 1 / np.sqrt(frames)),
    ]
    return point, np.minimum(np.concatenate(width), 1.0)


def _sum_patterns(state: State, collapse: LocalCollapse) -> tuple[NDArray, NDArray]:
    """Sums over the trials of each pattern of present joints."""
    alike = [collapse.pattern == k for k in range(len(collapse.patterns))]
    return tuple(
        np.stack([sums[chosen].sum(axis=0) for chosen in alike])
        for sums in (state.sums, state.first_sums)
    )
