"""A campaign as a mixed-effects problem."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.budget import BUDGET
from softfinger.inference.first_guess import guess_own
from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_laplace import Fit, fit_nonlinear
from softfinger.inference.mixed_effects_linearised import SharedBounds
from softfinger.inference.priors import PRIORS, PopulationPrior, build_prior
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.setting import build_setting, read_geometry
from softfinger.measurement.measure import measure
from softfinger.measurement.trials import Trials, prepare_trials
from softfinger.mechanics import OWN
from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import LONGEST_STEP, EffectModel
from softfinger.mechanics.effects.model_file import ModelFile, build_model
from softfinger.mechanics.forward.simulate import (
    Finger,
    describe_finger,
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.geometry import FingerGeometry

LAYOUT = ("trial", "joint", "frame")


class Candidate(NamedTuple):
    """A model, its fit and its log evidence [nats].

    `fit` is None where only its score is known.
    """

    model: EffectModel
    fit: Fit | None
    log_evidence: float


@dataclass(frozen=True, eq=False)
class Problem:
    """What every fit of a campaign shares."""

    trials: Trials
    noise: xr.Dataset
    finger: Finger
    population: PopulationPrior
    setting: Setting
    repaired: EffectModel | None = None
    directions: NDArray[np.float64] | None = None
    """(trial, joint, bin · 2, k) [rad] along which disturbances of sd 1 move the angles"""
    disturbed: Mapping[str, float] = field(default_factory=dict)
    """Id → sd of the disturbances that the noise includes."""

    @property
    def base(self) -> EffectModel:
        """The model without any effect, or as repaired."""
        return EffectModel(self.setting) if self.repaired is None else self.repaired

    def simulate(
        self,
        model: EffectModel,
        own: NDArray[np.float64],
        shared: NDArray[np.float64],
        only: NDArray[np.int64] | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Angles and derivatives at the bins' nodes.

        Angles (trial, joint, node), derivatives (trial, joint, node, 4 · joint + p).

        With `only` the derivatives are those by these places of φ alone, which is quicker.
        """
        trials = self.trials
        own = own.reshape(len(own), trials.joints, OWN)
        return simulate_joint_angle_array(
            own,
            model.fill_slots(shared),
            model.fill_tangents(shared, only),
            self.finger,
            trials.node.reshape(len(own), -1),
            trials.load_time,
            trials.load_torque,
            by_own=only is None,
            tolerance=BUDGET.angle_error,
        )

    def linearise(
        self, model: EffectModel, own: NDArray[np.float64], shared: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Gram matrices (trial, …) of the linearised model.

        Of [∂F/∂η | ∂F/∂φ | residual]; NaN where there is no motion.
        """
        try:
            angle, slope = self.simulate(model, own, shared)
        except (ArithmeticError, Fault):
            size = own.shape[1] + len(shared) + 1
            return np.full((len(own), size, size), np.nan)
        return reduce_trials(self.trials, angle, slope)

    def build_prior(self, model: EffectModel) -> Prior:
        """Priors of μ, φ and Ω."""
        mean, sd = model.shared_prior
        joints = self.trials.joints
        return Prior(
            np.concatenate([np.tile(self.population.mu_mean, joints), mean]),
            np.concatenate([np.tile(self.population.mu_sd, joints), sd]) ** -2.0,
            np.tile(PRIORS.spread, joints),
            PRIORS.spread_weight,
            OWN,
        )

    def build_bounds(self, model: EffectModel) -> SharedBounds:
        """Bounds and longest steps of φ."""
        return SharedBounds(model.low, model.high, LONGEST_STEP * model.shared_prior[1])

    def fit(
        self,
        model: EffectModel,
        start: tuple[NDArray, NDArray, NDArray],
        *,
        steps: int | None = None,
        tolerance: float = 0.02,
        first: float = -np.inf,
        rival: float = -np.inf,
    ) -> Fit | None:
        """Fit a model from (η, φ, Ω).

        Returns None where the numbers leave the plausible range.

        `first` is the log evidence from which its gain counts: the digits asked of it follow;
        `rival` that which is worth reaching.
        """
        longest = np.tile(BUDGET.longest_step, self.trials.joints)
        try:
            return fit_nonlinear(
                lambda own, shared: self.linearise(model, own, shared),
                self.build_prior(model),
                self.build_bounds(model),
                longest,
                start,
                steps=steps or max(BUDGET.steps, BUDGET.few_trials_steps // len(self.trials.name)),
                tolerance=tolerance,
                first=first,
                rival=rival,
            )
        except np.linalg.LinAlgError:
            return None


def pose_problem(
    angles: xr.Dataset, content: ModelFile | None = None, *, priors: bool = True
) -> tuple[Problem, Fit]:
    """Prepare a campaign and fit the base model.

    The base model is fitted as if the noise were white; the noise is then estimated from what it
    leaves, which is smoother than the motion, so that quiet windows show nothing but noise.

    Parameters
    ----------
    content
        A model file whose model takes the place of the base.
    priors
        Whether the file's priors count; they do not where they come from these recordings.

    Returns
    -------
    problem, fit
        What models with effects gain counts from this fit.

    Raises
    ------
    Fault
        The base model cannot be fitted.
    """
    noise = measure(angles)
    white = noise.assign(noise_autocorrelation=0.0 * noise["noise_autocorrelation"])
    problem, fit = _fit_base(angles, white, None)
    seen = angles.sel(trial=problem.trials.name)
    motion = predict_frames(problem, Candidate(problem.base, fit, fit.log_evidence), seen)
    problem, fit = _fit_base(seen, measure(seen, motion), fit)
    if content is not None:
        problem, fit = _repair_base(problem, fit, content, priors=priors)
    return problem, fit._replace(first=fit.log_evidence)


def _repair_base(
    problem: Problem, fit: Fit, content: ModelFile, *, priors: bool
) -> tuple[Problem, Fit]:
    """Fit the model of a file.

    Its priors lead to the mode, whether they count or not.
    """
    model = build_model(content, problem.setting)
    start = _find_start(problem, model, fit.own, model.shared_prior[0])
    again = problem.fit(model, (fit.own, start, fit.omega), steps=BUDGET.steps)
    if again is not None and not priors:
        model = build_model(content, problem.setting, priors=False)
        near = again.own, again.shared, again.omega
        again = problem.fit(model, near, steps=BUDGET.steps)
    if again is None:
        raise Fault("the model of the model file cannot be fitted to these recordings")
    return replace(problem, repaired=model), again


def _find_start(
    problem: Problem, model: EffectModel, own: NDArray, shared: NDArray
) -> NDArray[np.float64]:
    """Start with as much of the effects as moves.

    With more, the base model's trials have no motion.
    """
    for part in BUDGET.start_parts:
        start = np.clip(np.where(model.amplitudes, part * shared, shared), model.low, model.high)
        if np.isfinite(problem.linearise(model, own, start)).all():
            break
    return start


def _fit_base(angles: xr.Dataset, noise: xr.Dataset, before: Fit | None) -> tuple[Problem, Fit]:
    trials = prepare_trials(angles, noise)
    guess = guess_own(trials)
    own = np.tile(guess.ravel(), (len(trials.name), 1))
    own[:, OWN - 1 :: OWN] = _first_angle(trials, guess)
    omega = np.diag(np.tile(BUDGET.start_spread, trials.joints) * np.ones(own.shape[1])) ** 2
    start = (own, np.zeros(0), omega) if before is None else (before.own, np.zeros(0), before.omega)
    geometry = read_geometry(angles)
    unknown = describe_unknown_finger(trials.joints)
    middle = (0.0 if geometry is None else geometry.link_length.sum() / 2, 0.0)
    # ASSUME: the camera looks at the middle of the straight finger
    finger = unknown if geometry is None else describe_finger(geometry, optical_centre=middle)
    population = build_prior(*(data.sel(trial=trials.name) for data in (angles, noise)))
    problem = Problem(trials, noise, finger, population, build_setting(angles, trials, own))
    fit = problem.fit(problem.base, start, steps=BUDGET.steps)
    if fit is None:
        raise Fault(
            "the base model cannot be fitted to these recordings: check that load and angles "
            "belong together and that their units are those of the format"
        )
    setting = build_setting(angles, trials, fit.own)
    if geometry is None:
        finger = finger._replace(inertia=compute_usual_inertia(setting))
    return replace(problem, setting=setting, finger=finger), fit


def predict_frames(
    problem: Problem, candidate: Candidate, angles: xr.Dataset
) -> NDArray[np.float64]:
    """Angles (trial, joint, frame) [rad] at the trials' modes."""
    return simulate_frames(problem, candidate, angles, gradient=False)[0]


def simulate_frames(
    problem: Problem, candidate: Candidate, angles: xr.Dataset, *, gradient: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angles at every frame.

    With `gradient` also ∂F/∂η (trial, joint, frame, d).
    """
    trials = problem.trials
    own = candidate.fit.own.reshape(len(trials.name), trials.joints, OWN)
    time = angles.sel(trial=trials.name)["time"].transpose("trial", "frame").values
    forward = np.maximum.accumulate(np.where(np.isfinite(time), time, -np.inf), axis=1)
    return simulate_joint_angle_array(
        own,
        candidate.model.fill_slots(candidate.fit.shared),
        [],
        problem.finger,
        np.where(np.isfinite(time), forward, np.nan),
        trials.load_time,
        trials.load_torque,
        by_own=gradient,
        tolerance=BUDGET.angle_error,
    )


def compute_usual_inertia(setting: Setting) -> NDArray[np.float64]:
    """Inertia (joint, joint) that swings in ten frames."""
    even = np.ones(setting.joints)
    shape = compute_inertia_coefficients(FingerGeometry.uniform(even, even, 1.0, 1.0))
    return shape / shape.sum() * setting.stiffness[0] * (10 * setting.interval / 2 / np.pi) ** 2


def _first_angle(trials: Trials, guess: NDArray) -> NDArray:
    first = trials.angle[:, :3].mean(axis=1)
    return np.where(trials.present, np.nan_to_num(first), guess[:, OWN - 1])
