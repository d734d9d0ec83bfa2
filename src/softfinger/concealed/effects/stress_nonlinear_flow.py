"""Creep rate with an additional 1.5 power.

The rate is τ/c_p (1 + (s τ)^1.5): s [1/(N m)] is the inverse of the scale torque.
"""

from softfinger.concealed.effects.effect import Effect, set_amount

EFFECT = Effect(
    id="stress_nonlinear_flow",
    sentence="creep rate more than proportional to torque",
    level="within_trial",
    joints="any",
    typical=20.0,
    largest=80.0,
    move=set_amount("flow_scale"),
    tell=lambda dose, trials: {"scale_torque_nm": 1.0 / max(dose.strength, 1e-9)},
)
