"""A plane that is not horizontal: torque that depends on the configuration.

Free: what the links weigh beyond each joint is not what their masses say, as with a payload.
"""

from dataclasses import replace

from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    signed,
)


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.masses:
        return "link masses and lengths are not declared"
    along = signed("tilt_along_rad", 0.2, low=-1.6, high=1.6, floor=2e-4)
    across = signed("tilt_across_rad", 0.2, low=-1.6, high=1.6, floor=2e-4)

    def slots(values: Values) -> dict:
        return {name.removesuffix("_rad"): value for name, value in values.items()}

    def alone(tilt: Parameter) -> tuple[Parameter]:
        """Give the angle between plane and horizon, and beside it the way it tilts."""
        return (replace(tilt, report={"tilt_rad": lambda x, _: abs(x), tilt.name: lambda x, _: x}),)

    ratio = Parameter("moment_ratio", 0.0, 0.7, per="joint", log=True, low=-2.0, high=2.5)

    def loaded(values: Values) -> dict:
        tilt = {f"tilt_{way}": values[f"tilt_{way}_rad"] for way in ("across", "along")}
        return {**tilt, "moment_share": values["moment_ratio"] - 1.0}

    return [
        Form("across", alone(across), slots),
        Form("along", alone(along), slots),
        Form("both", (across, along), slots),
        Form(FREE, (across, along, ratio), loaded),
    ]


EFFECT = Effect(
    "gravity", "gravity pulls: the plane is tilted", "within_trial", _build_forms, "plane"
)
