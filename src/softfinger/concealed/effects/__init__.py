"""The effects of the proof: the catalogue's ids in forms of their own, and some outside it."""

from __future__ import annotations

from softfinger.concealed.effects import (
    actuator_lag,
    camera_delay,
    camera_swing,
    contact_stop,
    fatigue_softening,
    fractional_creep,
    gravity,
    inertia,
    joint_coupling,
    joint_play,
    lens_distortion,
    marker_slip,
    moment_arm,
    mullins_softening,
    picture_stretch,
    preload_memory,
    second_retardation,
    session_jump,
    strain_stiffening,
    stress_nonlinear_flow,
    temperature,
    tension_ripple,
    thinning_damper,
    wire_friction,
    yield_threshold,
)
from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape

EFFECTS: dict[str, Effect] = {
    module.EFFECT.id: module.EFFECT
    for module in (
        second_retardation,
        fractional_creep,
        strain_stiffening,
        wire_friction,
        moment_arm,
        actuator_lag,
        fatigue_softening,
        temperature,
        preload_memory,
        contact_stop,
        yield_threshold,
        stress_nonlinear_flow,
        joint_coupling,
        gravity,
        inertia,
        camera_delay,
        lens_distortion,
        tension_ripple,
        camera_swing,
        session_jump,
        joint_play,
        thinning_damper,
        mullins_softening,
        picture_stretch,
        marker_slip,
    )
}
LISTED = tuple(name for name, effect in EFFECTS.items() if effect.listed)
OUTSIDE = tuple(name for name, effect in EFFECTS.items() if not effect.listed)

__all__ = ["EFFECTS", "LISTED", "OUTSIDE", "Circumstances", "Dose", "Effect", "Shape"]
