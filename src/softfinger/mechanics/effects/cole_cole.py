"""A springpot instead of the Voigt element's damper.

A spring k_v beside a springpot of exponent a creeps with the broad spectrum of Cole and Cole,

    L(τ) = sin πa / (2π (cosh(a ln(τ/τ₀)) + cos πa)) / k_v,    τ₀ = c_v/k_v,

for each e-fold of retardation time: for a = 1 it is the one line of the damper.

Cole, Cole (1941), J. Chem. Phys. 9, 341.
"""

import math

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Form, Parameter, Values
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import FAST, LADDER, RATES, SPACING, VOIGT, WITH_LADDER
from softfinger.mechanics.forward.slot import LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

NARROWEST = 0.7
"""Largest exponent. A narrower band falls between the ladder's steps.

Up to here the angle is right to 0.2 %
(`tests/reference/mechanics/test_forward.py::test_a_springpot_instead_of_the_damper_creeps_as_stated`).
"""

_SHARE, _EXPONENT = declare(
    broad_voigt_share=Slot(
        "joint", "1", 0.0, "share of the Voigt element's compliance with a springpot as damper"
    ),
    broad_voigt_exponent=Slot(
        "joint", "1", 0.6, "exponent a of that springpot", "positive", at_most=NARROWEST
    ),
)


@compiled
def broaden_voigt(model: Model, linear: Linear, j: int) -> None:
    """Move a share of the Voigt element to the ladder's modes.

    What relaxes faster than the ladder is a spring; what is slower is left out.
    """
    value, spring = model.joint[j], LADDER + RATES.size + 1
    share = value[_SHARE]
    own, rest, rest_centre, rest_exponent = linear.gain[j, VOIGT], 1.0, 0.0, 0.0
    linear.gain[j, VOIGT] = (1.0 - share) * own
    for c in model.columns[j]:
        change = -own * model.d_joint[c, j, _SHARE]
        linear.d_gain[j, VOIGT, c] = (1.0 - share) * linear.d_gain[j, VOIGT, c] + change
    for step in range(RATES.size):
        part, by_centre, by_exponent = weigh_band(
            -math.log(RATES[step]) - (value[LOG_C_V] - value[LOG_K_V]), value[_EXPONENT]
        )
        _add_part(model, linear, j, LADDER + step, RATES[step], part, by_centre, by_exponent)
        if step == 0:  # all slower ones, a geometric sum
            fall = 1.0 / -math.expm1(-value[_EXPONENT] * SPACING)
            slope = -SPACING * math.exp(-value[_EXPONENT] * SPACING) * fall**2
            by_exponent = by_exponent * fall + part * slope
            part, by_centre = part * fall, by_centre * fall
        rest, rest_centre = rest - part, rest_centre - by_centre
        rest_exponent -= by_exponent
    _add_part(model, linear, j, spring, FAST, rest, rest_centre, rest_exponent)


@compiled
def _add_part(
    model: Model, linear: Linear, j: int, mode: int, rate: float,
    part: float, by_centre: float, by_exponent: float,
) -> None:  # fmt: skip
    """Add a part of the band to a mode, with its slopes."""
    value = model.joint[j]
    share, unit = value[_SHARE], math.exp(-value[LOG_K_V]) * rate
    linear.gain[j, mode] += share * unit * part
    for c in model.columns[j]:
        moved = model.d_joint[c, j]
        change = (moved[_SHARE] - share * moved[LOG_K_V]) * part
        change += share * by_centre * (moved[LOG_C_V] - moved[LOG_K_V])
        change += share * by_exponent * moved[_EXPONENT]
        linear.d_gain[j, mode, c] += unit * change


@compiled
def weigh_band(away: float, exponent: float) -> tuple[float, float, float]:
    """Share of a ladder's step in the band.

    `away` is ln(τ/τ₀). Returns it with its slopes by ln τ₀ and by the exponent.
    """
    sine, cosine = math.sin(math.pi * exponent), math.cos(math.pi * exponent)
    x = min(abs(exponent * away), 300.0)
    width = math.cosh(x) + cosine
    part = SPACING * sine / (2.0 * math.pi * width)
    steep = part * math.sinh(x) / width * (1.0 if away >= 0.0 else -1.0)
    by_exponent = SPACING * (cosine + sine * sine / width) / (2.0 * width) - steep * away
    return part, steep * exponent, by_exponent


BAND = Hook("modes", broaden_voigt, ("broad_voigt_share",), modes=WITH_LADDER)


def build_band() -> Form:
    """Build the form: a share of the Voigt element, and its exponent."""
    share = Parameter(
        "broad_share", 0.0, 0.5, low=0.0, high=1.0, amplitude=True, floor=5e-4, starts=(0.005,)
    )
    exponent = Parameter("exponent", 0.55, 0.2, low=0.2, high=NARROWEST, starts=(0.4, 0.65))

    def broaden(values: Values) -> dict:
        return {
            "broad_voigt_share": values["broad_share"],
            "broad_voigt_exponent": values["exponent"],
        }

    return Form("instead_of_damper", (share, exponent), broaden)
