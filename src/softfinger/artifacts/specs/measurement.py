"""Which frames count, and how large their noise is."""

from softfinger.artifacts.spec import ArtifactSpec, Variable
from softfinger.units import UNIT_ATTRS

_FRAME = ("trial", "frame")

SPEC = ArtifactSpec(
    name="measurement",
    title="What the recordings suffer from",
    rule="diagnose",
    attrs=("campaign", "source"),
    optional_attrs=UNIT_ATTRS,
    coords={
        "trial": Variable(("trial",), "1", "name of the trial", "text"),
        "joint": Variable(("joint",), "1", "number of the joint, base to tip", "whole number"),
        "other_joint": Variable(("other_joint",), "1", "number of the joint", "whole number"),
        "component": Variable(("component",), "1", "what the recordings suffer from", "text"),
    },
    variables={
        "present": Variable(("trial", "joint"), "1", "joint seen often enough", "truth value"),
        "used": Variable(_FRAME, "1", "frame that counts", "truth value", compress=True),
        "repeated": Variable(
            _FRAME, "1", "frame that repeats the one before", "truth value", compress=True
        ),
        "saturated": Variable(
            _FRAME, "1", "frame at or after a limit of a sensor", "truth value", compress=True
        ),
        "outlier_distance": Variable(
            _FRAME,
            "1",
            "squared distance from its neighbours of a gross error, in sd of the noise; else 0",
            at_least=0.0,
            compress=True,
        ),
        "frame_scale": Variable(
            _FRAME, "1", "sd that the frame claims over the usual one", at_least=0.0, compress=True
        ),
        "trial_factor": Variable(
            ("trial", "joint"), "1", "sd of the noise over the campaign's", at_least=0.0
        ),
        "noise_sd": Variable(("joint",), "rad", "marginal sd of the noise at rest", at_least=0.0),
        "noise_autocorrelation": Variable(
            ("joint",), "1", "of the noise over a median frame interval", at_least=0.0, at_most=1.0
        ),
        "noise_white": Variable(
            ("joint",), "1", "share of the noise new in every frame", at_least=0.0, at_most=1.0
        ),
        "noise_correlation": Variable(
            ("joint", "other_joint"), "1", "of the innovations", at_least=-1.0, at_most=1.0
        ),
        "noise_per_rad": Variable(
            (), "1", "c [1/rad] of the growth √(1 + c² x²) with the deflection x", at_least=0.0
        ),
        "noise_per_rate": Variable(
            (), "1", "a [s/rad] of the growth √(1 + a² v²) with the speed v", at_least=0.0
        ),
        "window_count": Variable(
            ("joint",), "1", "quiet windows that show the noise", "whole number", at_least=0
        ),
        "component_size": Variable(
            ("component",), "1", "its size, in the unit of the verdict's finding"
        ),
        "component_evidence": Variable(("component",), "1", "its evidence [nats]"),
        "clock_rate": Variable(
            (), "1", "how slow the camera's clock runs, which was set right", optional=True
        ),
        "clock_offset": Variable(
            ("trial",),
            "s",
            "how much later than stated its frames are, which was set right",
            optional=True,
        ),
        "steady_load": Variable(
            (), "1", "levels and ramps of the load are steady", "truth value", optional=True
        ),
        "ramps_held": Variable(
            (), "1", "each row of a ramp stays until the next one", "truth value", optional=True
        ),
        "load_tared": Variable(
            (), "1", "the log's first reading is taken off", "truth value", optional=True
        ),
        "steps_early": Variable(
            (),
            "1",
            "how much sooner steps of the load come, as a share of the gaps of its log",
            optional=True,
        ),
        "steps_open": Variable(
            (),
            "1",
            "steps of the load come at any moment of the gaps of its log",
            "truth value",
            optional=True,
        ),
        "step_share": Variable(
            ("trial", "step"),
            "1",
            "how much sooner each step of the load comes, as a share of the gap of its log",
            optional=True,
        ),
        "hum_frequency": Variable(
            ("hum",), "Hz", "of what the angles hum, strongest first", at_least=0.0
        ),
    },
)
