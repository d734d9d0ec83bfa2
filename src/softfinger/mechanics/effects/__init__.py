"""The catalogue of left-out physics.

Each effect is one file; effects of others may join.

A package adds its own by an entry point in the group `softfinger.effects` that names an `Effect`.
"""

from functools import cache
from importlib.metadata import entry_points

from softfinger.faults import Fault
from softfinger.mechanics.effects import (
    actuator_lag,
    camera_delay,
    contact_stop,
    fatigue_softening,
    fractional_creep,
    gravity,
    inertia,
    joint_coupling,
    joint_play,
    lens_distortion,
    load_gain,
    load_limit,
    moment_arm,
    preload_memory,
    second_retardation,
    session_jump,
    softening_within_trial,
    strain_stiffening,
    stress_nonlinear_flow,
    temperature,
    thinning_damper,
    wire_friction,
    yield_threshold,
)
from softfinger.mechanics.effects.effect import Effect

MODULES = (
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
    session_jump,
    load_limit,
    load_gain,
    joint_play,
    thinning_damper,
    softening_within_trial,
)


@cache
def list_effects() -> dict[str, Effect]:
    """List every known effect by its id.

    >>> list(list_effects())[:2]
    ['second_retardation', 'fractional_creep']
    """
    effects = {module.EFFECT.id: module.EFFECT for module in MODULES}
    for point in entry_points(group="softfinger.effects"):
        effect = point.load()
        if not isinstance(effect, Effect):
            raise Fault(
                f"entry point {point.value!r} in group softfinger.effects is not an Effect: "
                "it must name an instance of softfinger.mechanics.effects.effect.Effect"
            )
        if effect.id in effects:
            raise Fault(f"effect id {effect.id!r} of {point.value!r} is taken: choose another")
        effects[effect.id] = effect
    return effects
