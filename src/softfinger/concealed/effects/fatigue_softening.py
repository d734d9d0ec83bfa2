"""Softening as a hyperbola of the trials done."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Soften as a hyperbola of the trials done.

    The stiffness is multiplied by 1 − s m / (m + m₀) after m trials, perhaps the viscosities too.

    m₀ is given as a share of the campaign's length.
    """
    half = dose.shape["half_way"] * trial.count
    left = 1.0 - dose.spread(physics.k_v.size) * trial.number / (trial.number + half)
    softened = physics._replace(k_v=physics.k_v * left)
    if dose.shape["viscosities_too"]:
        softened = softened._replace(c_v=physics.c_v * left, c_p=physics.c_p * left)
    return softened


EFFECT = Effect(
    id="fatigue_softening",
    sentence="parameters that drift with the number of trials done",
    level="between_trials",
    joints="any",
    typical=0.15,
    largest=0.5,
    shape={"half_way": Shape(0.15, 0.8), "viscosities_too": Shape(0.0, 1.0, choice=True)},
    move=_move,
    tell=lambda dose, trials: {f"softening_share_{j + 1}": dose.strength for j in dose.joints},
    covariate="trial_number",
    trials=10,
)
