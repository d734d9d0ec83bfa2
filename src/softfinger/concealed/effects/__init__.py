"""The effects of the proof, in their own forms.

They have the catalogue's ids, and some are outside the catalogue.
"""

from softfinger.concealed.effects import (
    actuator_lag,
    ageing_with_recovery,
    camera_delay,
    camera_swing,
    clamp_slip,
    contact_stop,
    dry_joint,
    fatigue_softening,
    fractional_creep,
    gravity,
    inertia,
    joint_coupling,
    joint_play,
    lens_distortion,
    load_gain,
    load_limit,
    marker_slip,
    moment_arm,
    mullins_softening,
    one_way_damper,
    picture_stretch,
    plastic_set,
    preload_memory,
    second_retardation,
    second_tendon,
    session_jump,
    softening_within_trial,
    sticky_start,
    strain_stiffening,
    stress_nonlinear_flow,
    temperature,
    tension_ripple,
    thinning_damper,
    thixotropic_dashpot,
    wire_friction,
    yield_threshold,
)
from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape

OWN: dict[str, Effect] = {
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
        load_limit,
        load_gain,
        softening_within_trial,
        plastic_set,
        clamp_slip,
        thixotropic_dashpot,
        second_tendon,
        ageing_with_recovery,
        dry_joint,
        one_way_damper,
        sticky_start,
    )
}
_IDS = tuple(OWN)
_FIRST, _LATER = _IDS[: _IDS.index("tension_ripple")], _IDS[_IDS.index("tension_ripple") :]
_MOVED = (  # into the second catalogue
    "session_jump",
    "load_limit",
    "load_gain",
    "joint_play",
    "thinning_damper",
    "softening_within_trial",
)
# The ids that a catalogue under test has, and what is outside it.
CATALOGUES = {"first": _FIRST, "second": (*_FIRST, *_MOVED)}
OUTSIDERS = {
    "first": _LATER[: _LATER.index("load_limit")],
    # no swing of the camera: the measurement model of that catalogue has slow drifts
    "second": tuple(name for name in _LATER if name not in (*_MOVED, "camera_swing")),
}

__all__ = ["CATALOGUES", "OUTSIDERS", "OWN", "Circumstances", "Dose", "Effect", "Shape"]
