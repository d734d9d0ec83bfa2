"""What wanders slowly in the angles of a trial.

A random walk goes ever farther; noise that lasts returns; flicker has as much in each octave. All
are a few shapes over the trial, each times a normal number of its own.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.problem import Problem
from softfinger.measurement.trials import Trials

Array = NDArray[np.float64]


def count_shapes(trials: int, joints: int) -> int:
    """How many shapes of a random walk count.

    >>> count_shapes(1, 1), count_shapes(4, 1), count_shapes(40, 3)
    (60, 16, 16)
    """
    return max(BUDGET.drift_shapes, BUDGET.drift_columns // (trials * joints))


def walk_array(share: Array, shapes: int) -> Array:
    """Leading shapes (…, k) of a random walk.

    It is over shares (…) of a trial, of sd 1 at its end.

    Karhunen–Loève: √2 sin((k − ½) π t/T) / ((k − ½) π).

    >>> bool(abs((walk_array(np.ones(1), 5) ** 2).sum() - 1.0) < 0.05)
    True
    """
    pitch = (np.arange(shapes) + 0.5) * np.pi
    return np.sqrt(2.0) * np.sin(share[..., None] * pitch) / pitch


def list_walks(problem: Problem) -> Array:
    """How a random walk of each joint moves angles.

    It has the noise's sd at a trial's end.
    """
    trials = problem.trials
    shapes = count_shapes(len(trials.name), trials.joints)
    walk = walk_array(share_trial(trials), shapes)[:, None]
    alone = np.eye(trials.joints)
    return _move_joints(problem, np.repeat(walk, trials.joints, axis=1), alone)


def list_waves(problem: Problem) -> Array:
    """How noise that lasts twice as long moves angles.

    Twice as long as quiet windows show, and as lively from frame to frame: it has more of its slow
    waves √2 cos(ω t), ω = k π/T. With σ and τ of the noise's lasting part, T its recording and
    x = ω τ, their variances are 6 σ² τ/T / ((1 + 4 x²) (1 + x²)): spectra at 2 τ less those at τ.
    The joints' waves are correlated as their noise is, and larger where it is. A quartic follows
    such waves in a window, and one that is shorter than the noise lasts does not show how long that
    is.
    """
    trials, noise = problem.trials, problem.noise
    lasts, span = _measure_memory(problem), _measure_span(trials)[:, None]
    number = np.arange(1, BUDGET.lasting_shapes + 1)
    turn = (number * np.pi * lasts[:, None] / span[:, None]) ** 2  # x² (trial, joint, k)
    size = 6.0 * (1.0 - noise["noise_white"].values) * lasts / span
    sd = np.sqrt(size[..., None] / ((1.0 + 4.0 * turn) * (1.0 + turn)))
    waves = np.sqrt(2.0) * np.cos(share_trial(trials)[..., None] * number * np.pi)
    shape = np.einsum("tnk,tjk->tjnk", waves, sd)
    return _move_as_noise(problem, shape)


def list_flicker(problem: Problem) -> Array:
    """How noise of equal power in each octave moves angles.

    Quiet windows show its fast part, as noise that is shorter than it is. With τ of that and T a
    recording, its slow waves √2 cos(ω t), ω = k π/T, have more power, in the ratio 1/k − 6 τ/T. As
    long as that is positive they count, and together have the noise's variance. Noise that is new
    in every frame has none. The joints' waves are correlated as their noise is, and larger where it
    is.
    """
    trials, lasts = problem.trials, _measure_memory(problem)
    lasts[lasts < float(problem.noise["frame_interval"])] = np.inf
    share = BUDGET.octave * lasts / _measure_span(trials)[:, None]
    most = BUDGET.flicker_columns // (len(trials.name) * trials.joints)
    most = min(int(1.0 / share.min()), max(BUDGET.drift_shapes, most))
    number = np.arange(1, most + 1)
    power = np.maximum(1.0 / number - share[..., None], 0.0)
    sd = np.sqrt(power / np.maximum(power.sum(axis=2, keepdims=True), np.finfo(float).tiny))
    waves = np.sqrt(2.0) * np.cos(share_trial(trials)[..., None] * number * np.pi)
    return _move_as_noise(problem, np.einsum("tnk,tjk->tjnk", waves, sd))


def turn_link(problem: Problem, link: int) -> Array:
    """How a direction that slowly turns in the picture moves angles.

    A random walk as in `list_walks`, of one direction: of the base (0), as where the camera turns,
    or of a link (from 1), as where its markers swim with the light. It moves the joint before the
    link one way, and the joint after it the other way.
    """
    walk = walk_array(share_trial(problem.trials), BUDGET.drift_shapes)
    moved = turn_joints(link, problem.trials.joints)
    sd = problem.noise["noise_sd"].values[int(moved.argmax())]
    return np.einsum("tns,j->tjns", walk, sd * moved)


def turn_joints(link: int, joints: int) -> Array:
    """How far each joint (joint,) seems to turn with a direction.

    >>> turn_joints(0, 3), turn_joints(1, 3), turn_joints(3, 3)
    (array([1., 0., 0.]), array([ 1., -1.,  0.]), array([0., 0., 1.]))
    """
    moved = np.zeros(joints)
    moved[max(link - 1, 0)] = 1.0
    if 0 < link < joints:
        moved[link] = -1.0
    return moved


def share_trial(trials: Trials) -> Array:
    """How much of a trial has gone by (trial, bin · 2)."""
    node = trials.node.reshape(len(trials.name), -1)
    return (node - node[:, :1]) / np.maximum(node[:, -1:] - node[:, :1], 1e-300)


def _measure_memory(problem: Problem) -> Array:
    """How long each joint's noise lasts (joint,) [s]."""
    rho = np.maximum(problem.noise["noise_autocorrelation"].values, np.finfo(float).tiny)
    return -float(problem.noise["frame_interval"]) / np.log(rho)


def _measure_span(trials: Trials) -> Array:
    """How long trials are (trial,) [s]."""
    node = trials.node.reshape(len(trials.name), -1)
    return node[:, -1] - node[:, 0]


def _move_as_noise(problem: Problem, shape: Array) -> Array:
    """Move joints by shapes, as their noise moves them."""
    moved = _move_joints(problem, shape, problem.noise["noise_correlation"].values)
    return moved * np.repeat(problem.trials.scale.transpose(0, 2, 1), 2, axis=2)[..., None]


def _move_joints(problem: Problem, shape: Array, correlation: Array) -> Array:
    """Move joints, correlated (joint, joint), by shapes.

    They are (trial, joint, node, k), in units of the noise's sd.
    """
    sd = problem.noise["noise_sd"].values
    columns = np.einsum("tink,ij,i->tinjk", shape, np.linalg.cholesky(correlation), sd)
    return columns.reshape(*columns.shape[:3], -1)
