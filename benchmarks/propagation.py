"""Sobol indices and densities of the joint angle, beside tensor rules, SALib and quadrature.

The paper's table under its step of 30 s; where it says so, joint 3's c_p from log-normal(3.3, 0.9).
Ratios are of CPU time, within this run. References are written anew, by other rules than ours. The
Gauss–Hermite rule gets for each joint the fewest nodes with which its error is no larger than ours.
"""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from SALib.analyze import sobol as salib_analyze
from SALib.sample import sobol as salib_sample
from scipy.interpolate import make_interp_spline
from scipy.stats import gaussian_kde

from benchmarks.rivals import gauss_hermite
from softfinger.propagation.density import compute_density_array
from softfinger.propagation.independent import share_variance_array
from softfinger.propagation.quantiles import compute_quantiles_array
from softfinger.propagation.subsets import SobolIndices, compute_sobol_indices

MU = np.array(
    [
        [-2.4441, -3.6635, 2.8538, 0.02],
        [-2.2986, -3.6476, 3.1129, 0.02],
        [-1.8800, -3.8777, 1.3114, 0.02],
    ]
)
SIGMA = np.array(
    [
        [0.1973, 0.5232, 0.7011, 0.01],
        [0.2238, 0.4838, 0.8496, 0.01],
        [0.3957, 0.8223, 3.2316, 0.01],
    ]
)
TAMED = (3.3, 0.9)  # mu, sigma of joint 3's c_p without its tail
TORQUE = 0.04
STEP = ([0.0], [TORQUE])
TIME = 0.1 * np.arange(301)
N_ANGLE = 512
SALIB_N = 16384
CHECKED_TIMES = np.array([0.1, 1.0, 30.0])
DRAWN_TIMES = np.array([0.0, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0])
NODES = [(k, c) for k in (6, 8, 10, 12, 16) for c in (12, 16, 20, 24, 28, 32, 40)]
N_DRAWS = 1000
KDE_N = 10000


def measure() -> dict[str, float]:
    """Measure speed and error of indices and densities."""
    return {
        **measure_indices(),
        **compare_with_gauss_hermite(),
        **measure_densities(),
        **measure_draws(),
    }


def measure_indices() -> dict[str, float]:
    """Indices at 301 times of three joints, beside SALib at N = 16384."""
    _compute_indices(MU, SIGMA, TIME, *STEP)  # compiles
    ours, indices = _time(lambda: _compute_indices(MU, SIGMA, TIME, *STEP), repeat=20)
    salib, estimated = _time(lambda: [_run_salib(MU[j], SIGMA[j]) for j in range(3)])
    tamed = MU.copy(), SIGMA.copy()
    tamed[0][2, 2], tamed[1][2, 2] = TAMED
    error, salib_error = [], []
    for mu, sigma in ((MU, SIGMA), tamed):
        found = _compute_indices(mu, sigma, TIME, *STEP)
        for joint in range(3):
            first, total = _integrate_indices(mu[joint], sigma[joint])
            error.append(np.abs(found.first_order[joint] - first).max())
            error.append(np.abs(found.total[joint] - total).max())
    for joint in range(2):
        first, total = _integrate_indices(MU[joint], SIGMA[joint])
        salib_error.append(np.abs(estimated[joint][0] - first).max())
        salib_error.append(np.abs(estimated[joint][1] - total).max())
    on_joints_1_and_2 = max(error[:4])
    return {
        "sobol_milliseconds": 1e3 * ours,
        "sobol_speedup_vs_salib_16384": salib / ours,
        "sobol_error": max(error),
        "sobol_salib_error": max(salib_error),
        "sobol_error_ratio_to_salib": max(salib_error) / on_joints_1_and_2,
        "sobol_least_index": min(array.min() for array in indices),
    }


def compare_with_gauss_hermite() -> dict[str, float]:
    """Time of the indices of three joints over that of a tensor rule with the same error."""
    exact = [_integrate_indices(MU[j], SIGMA[j]) for j in range(3)]
    found = _compute_indices(MU, SIGMA, TIME, *STEP)
    ours = list(zip(found.first_order, found.total, strict=True))
    error = max(_find_error(*both) for both in zip(ours, exact, strict=True))
    chosen = [min(_list_good_nodes(joint, exact[joint], error)) for joint in range(3)]

    def run() -> list[tuple[NDArray, NDArray]]:
        return [_run_rule(joint, nodes) for joint, (_, nodes) in enumerate(chosen)]

    def run_ours() -> SobolIndices:
        return _compute_indices(MU, SIGMA, TIME, *STEP)

    pairs = [(_time(run_ours, 10)[0], _time(run, 10)[0]) for _ in range(5)]
    theirs = max(_find_error(*both) for both in zip(run(), exact, strict=True))
    print(f"  nodes {[nodes for _, nodes in chosen]}", flush=True)
    return {
        "sobol_time_ratio_to_gauss_hermite": float(np.median([a / b for a, b in pairs])),
        "sobol_gauss_hermite_milliseconds": 1e3 * float(np.median([b for _, b in pairs])),
        "sobol_gauss_hermite_error": theirs,
    }


def _list_good_nodes(
    joint: int, exact: tuple[NDArray, NDArray], error: float
) -> list[tuple[int, tuple[int, int]]]:
    """Size and numbers of nodes whose error is at most `error`."""
    return [
        (nodes[0] * nodes[1], nodes)
        for nodes in NODES
        if _find_error(_run_rule(joint, nodes), exact) <= error
    ]


def _run_rule(joint: int, nodes: tuple[int, int]) -> tuple[NDArray, NDArray]:
    return gauss_hermite.compute_indices(MU[joint], SIGMA[joint], TIME, TORQUE, nodes)


def _find_error(found: tuple[NDArray, NDArray], exact: tuple[NDArray, NDArray]) -> float:
    return max(float(np.abs(a - b).max()) for a, b in zip(found, exact, strict=True))


def measure_densities() -> dict[str, float]:
    """Densities at 301 times and 512 angles of three joints, beside two rivals on fewer times."""
    angles = [_space_angles(MU[j], SIGMA[j], TIME) for j in range(3)]
    some = [_space_angles(MU[j], SIGMA[j], CHECKED_TIMES) for j in range(3)]
    few = [grid[:, 7::32] for grid in some]

    def compute(times: NDArray, grids: list[NDArray]) -> list[NDArray]:
        sets = zip(MU, SIGMA, grids, strict=True)
        return [compute_density_array(mu, sd, times, *STEP, grid) for mu, sd, grid in sets]

    compute(TIME, angles)
    start = time.perf_counter()
    compute(TIME, angles)
    seconds = time.perf_counter() - start
    peak = [density.max(axis=1) for density in compute(CHECKED_TIMES, some)]
    ours, found = _time(lambda: compute(CHECKED_TIMES, some), repeat=5)
    ours_few, found_few = _time(lambda: compute(CHECKED_TIMES, few), repeat=5)
    rng = np.random.default_rng(1)
    kde, smoothed = _time(lambda: [_run_kde(*a, rng) for a in zip(MU, SIGMA, some, strict=True)])
    brute, expected = _time(lambda: [_integrate(*a) for a in zip(MU, SIGMA, few, strict=True)])

    def worst(ours: list[NDArray], other: list[NDArray]) -> float:
        return max(
            (np.abs(a - b).max(axis=1) / p).max()
            for a, b, p in zip(ours, other, peak, strict=False)
        )

    return {
        "density_seconds": seconds,
        "density_error": worst(found_few, expected),
        "density_kde_error_joints_1_2": worst(found[:2], smoothed[:2]),
        "density_speedup_vs_kde_10000": kde / ours,
        "density_speedup_vs_quadrature": brute / ours_few,
    }


def measure_draws() -> dict[str, float]:
    """Indices at all times and densities at twelve, for 1000 posterior draws, wall seconds."""
    rng = np.random.default_rng(2)
    mu, sigma = MU.copy(), SIGMA.copy()
    mu[2, 2], sigma[2, 2] = TAMED
    shape = (N_DRAWS, 3, 4)
    mus = mu + 0.1 * sigma * rng.standard_normal(shape)
    sigmas = sigma * np.exp(0.1 * rng.standard_normal(shape))
    angles = [_space_angles(mu[j], sigma[j], DRAWN_TIMES) for j in range(3)]
    start = time.perf_counter()
    _compute_indices(mus, sigmas, TIME, *STEP)
    for draw in range(N_DRAWS):
        for joint in range(3):
            compute_density_array(
                mus[draw, joint], sigmas[draw, joint], DRAWN_TIMES, *STEP, angles[joint]
            )
    return {"sobol_and_density_seconds_1000_draws": time.perf_counter() - start}


def _compute_indices(*arguments: ArrayLike) -> SobolIndices:
    return compute_sobol_indices(share_variance_array(*arguments))


def _time[Result](task: Callable[[], Result], repeat: int = 1) -> tuple[float, Result]:
    start = time.process_time()
    for _ in range(repeat):
        result = task()
    return (time.process_time() - start) / repeat, result


def _space_angles(mu: NDArray, sigma: NDArray, times: NDArray) -> NDArray:
    """Angles (time, 512) from the 0.1 % to the 75 % quantile and as far again."""
    low, high = compute_quantiles_array(mu, sigma, times, *STEP, [0.001, 0.75]).T
    return np.linspace(low, high + (high - low), N_ANGLE, axis=-1)


def _step_response(parameters: NDArray) -> NDArray:
    k_v, c_v, c_p, q_ini = parameters.T[:, :, None]
    return TORQUE / k_v * -np.expm1(-k_v / c_v * TIME) + TORQUE / c_p * TIME + q_ini


def _run_salib(mu: NDArray, sigma: NDArray) -> tuple[NDArray, NDArray]:
    """First-order and total indices (time, 4); two bootstraps only, so as not to slow it."""
    problem = {
        "num_vars": 4,
        "names": ["k_v", "c_v", "c_p", "q_ini"],
        "dists": ["lognorm", "lognorm", "lognorm", "norm"],
        "bounds": np.stack([mu, sigma], axis=1).tolist(),
    }
    sample = salib_sample.sample(problem, SALIB_N, calc_second_order=False, seed=1)
    angle = _step_response(sample)
    first, total = [], []
    for column in angle.T:
        found = salib_analyze.analyze(
            problem, column, calc_second_order=False, num_resamples=2, seed=1
        )
        first.append(found["S1"])
        total.append(found["ST"])
    return np.array(first), np.array(total)


def _integrate_indices(mu: NDArray, sigma: NDArray) -> tuple[NDArray, NDArray]:
    """First-order and total indices (time, 4) by Gauss–Hermite rules of 120 × 120 nodes."""
    z, w = np.polynomial.hermite_e.hermegauss(120)
    w = w / w.sum()
    k = np.exp(mu[0] + sigma[0] * z)[:, None, None]
    c = np.exp(mu[1] + sigma[1] * z)[:, None]
    elastic = TORQUE / k * -np.expm1(-k / c * TIME)
    given_k, given_c = np.tensordot(elastic, w, (1, 0)), np.tensordot(w, elastic, 1)
    mean = w @ given_k
    v_k, v_c = w @ (given_k - mean) ** 2, w @ (given_c - mean) ** 2
    v_kc = w @ np.tensordot(w, (elastic - given_k[:, None] - given_c + mean) ** 2, 1)
    inverse = np.exp(-2 * mu[2] + sigma[2] ** 2) * np.expm1(sigma[2] ** 2)
    flow = (TORQUE * TIME) ** 2 * inverse
    start = np.full(TIME.size, sigma[3] ** 2)
    whole = v_k + v_c + v_kc + flow + start
    first = np.stack([v_k, v_c, flow, start], axis=1) / whole[:, None]
    both = (v_kc / whole)[:, None] * [1, 1, 0, 0]
    return first, first + both


def _run_kde(mu: NDArray, sigma: NDArray, angles: NDArray, rng: np.random.Generator) -> NDArray:
    x = mu + sigma * rng.standard_normal((KDE_N, 4))
    k, c, c_p, q_ini = *np.exp(x[:, :3]).T, x[:, 3]
    density = []
    for t, grid in zip(CHECKED_TIMES, angles, strict=True):
        angle = TORQUE / k * -np.expm1(-k / c * t) + TORQUE / c_p * t + q_ini
        density.append(gaussian_kde(angle)(grid))
    return np.array(density)


def _integrate(mu: NDArray, sigma: NDArray, angles: NDArray) -> NDArray:
    """Density by quadrature over c_p (Gauss–Legendre panels), then over k_v and c_v (351²)."""
    z = np.linspace(-7, 7, 351)
    weight = np.exp(-z * z / 2)
    weight = np.outer(weight, weight) / weight.sum() ** 2
    k, c = np.exp(mu[0] + sigma[0] * z)[:, None], np.exp(mu[1] + sigma[1] * z)
    density = []
    for t, grid in zip(CHECKED_TIMES, angles, strict=True):
        elastic = TORQUE / k * -np.expm1(-k / c * t)
        top = grid.max() - mu[3]
        v = np.arange(-10 * sigma[3], top + sigma[3], sigma[3] / 8)
        rest = make_interp_spline(v, _integrate_flow(v, TORQUE * t, mu[2], sigma[2], sigma[3]), k=7)
        for angle in grid:
            left = angle - mu[3] - elastic
            density.append(np.sum(weight * np.where(left > v[0], rest(np.maximum(left, v[0])), 0)))
    return np.reshape(density, angles.shape)


def _integrate_flow(
    v: NDArray, impulse: float, mu: float, sigma: float, sd: float
) -> NDArray[np.float64]:
    edges = [impulse * np.exp(-mu - 9 * sigma)]
    while edges[-1] < min(v.max() + 9 * sd, impulse * np.exp(-mu + 9 * sigma)):
        edges.append(min(edges[-1] * np.exp(0.3 * min(sigma, 1.0)), edges[-1] + sd))
    edges = np.array(edges)
    point, weight = np.polynomial.legendre.leggauss(12)
    half = np.diff(edges)[:, None] / 2
    flow = ((edges[1:] + edges[:-1])[:, None] / 2 + half * point).ravel()
    z = (np.log(flow / impulse) + mu) / sigma
    mass = np.exp(-z * z / 2) / (flow * sigma * np.sqrt(2 * np.pi)) * (half * weight).ravel()
    return np.exp(-(((v[:, None] - flow) / sd) ** 2) / 2) @ mass / (sd * np.sqrt(2 * np.pi))
