"""Power-law creep: a springpot.

Creep ∝ t^a / Γ(1 + a), beside or instead of the dashpot c_p, or instead of the damper c_v.

Bagley, Torvik (1983), J. Rheol. 27, 201.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.cole_cole import BAND, build_band
from softfinger.mechanics.effects.creep_spectrum import (
    CREEP,
    SPECTRUM,
    build_spectra,
)
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import FAST, FLOW, LADDER, RATES, SPACING, WITH_LADDER
from softfinger.mechanics.forward.slot import LOG_C_P, LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

LEAST_LOSS = 1e-4  # an exponent of exactly 1 is the dashpot and no springpot


_COMPLIANCE, _ELASTIC, _FLOW, _EXPONENT, _FLOW_SHARE, _OWN = declare(
    springpot_compliance=Slot(
        "joint", "rad/(N m s^a)", 0.0, "springpot in series: creep · t^a / Γ(1 + a)"
    ),
    springpot_elastic_share=Slot("joint", "s^-a", 0.0, "the same, as a share of 1/k_v"),
    springpot_flow_share=Slot("joint", "s^(1-a)", 0.0, "the same, as a share of 1/c_p"),
    springpot_exponent=Slot(
        "joint", "1", 0.5, "its exponent a, 0 = spring, 1 = dashpot", "nonnegative", at_most=1.0
    ),
    flow_share=Slot("joint", "1", 1.0, "factor on the dashpot's flow; 0 takes it away"),
    springpot_own_time=Slot(
        "joint", "1", 0.0, "1: the springpot's time is in units of the joint's c_v/k_v",
        constant=True,
    ),
)  # fmt: skip


@compiled
def scale_flow(model: Model, linear: Linear, j: int) -> None:
    """The dashpot's gain times flow_share."""
    share, gain = model.joint[j, _FLOW_SHARE], linear.gain[j, FLOW]
    linear.gain[j, FLOW] = share * gain
    for c in model.columns[j]:
        change = share * linear.d_gain[j, FLOW, c] + gain * model.d_joint[c, j, _FLOW_SHARE]
        linear.d_gain[j, FLOW, c] = change


@compiled
def add_springpot(model: Model, linear: Linear, j: int) -> None:
    """A springpot as gains of the ladder's modes.

    Its creep rate t^{a−1}/Γ(a) = (sin πa/π) ∫ λ^{−a} e^{−λt} dλ becomes a trapezoidal sum in log λ.
    The rates below those of the ladder act as a dashpot, those above as a spring, both summed
    exactly: a → 1 is the dashpot, a → 0 the spring. Its creep compliance is within 6e-5 of
    t^a/Γ(1 + a), relatively, from 5 ms to 200 s.
    """
    value = model.joint[j]
    soft, thin = math.exp(-value[LOG_K_V]), math.exp(-value[LOG_C_P])
    compliance = value[_COMPLIANCE] + value[_ELASTIC] * soft + value[_FLOW] * thin
    longer = value[_OWN] * (value[LOG_C_V] - value[LOG_K_V])  # log of the unit of time
    pace = math.exp(-value[_EXPONENT] * longer)
    for step in range(WITH_LADDER - LADDER):
        weight, by_exponent = springpot_weight(step, value[_EXPONENT])
        weight, by_exponent = pace * weight, pace * (by_exponent - longer * weight)
        linear.gain[j, LADDER + step] += compliance * weight
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            d_compliance = (change[_ELASTIC] - value[_ELASTIC] * change[LOG_K_V]) * soft
            d_compliance += (change[_FLOW] - value[_FLOW] * change[LOG_C_P]) * thin
            d_gain = (change[_COMPLIANCE] + d_compliance) * weight
            d_gain += compliance * by_exponent * change[_EXPONENT]
            d_longer = value[_OWN] * (change[LOG_C_V] - change[LOG_K_V])
            d_gain -= compliance * weight * value[_EXPONENT] * d_longer
            linear.d_gain[j, LADDER + step, c] += d_gain


@compiled
def springpot_weight(step: int, exponent: float) -> tuple[float, float]:
    """Gain of a ladder's step, its slope by exponent."""
    last, missing = RATES.size, 1.0 - exponent
    if step < last:
        reach = math.sin(math.pi * missing) / math.pi
        power = SPACING * RATES[step] ** missing
        turn = -math.cos(math.pi * missing) - reach * math.log(RATES[step])
        return reach * power, turn * power
    if step == last:  # all slower rates: a dashpot
        share, climb = _sum_tail(missing)
        weight = share * RATES[0] ** missing
        return weight, -weight * (climb + math.log(RATES[0]))
    share, climb = _sum_tail(exponent)  # all faster rates: a spring
    weight = share * FAST * RATES[-1] ** -exponent
    return weight, weight * (climb - math.log(RATES[-1]))


@compiled
def _sum_tail(x: float) -> tuple[float, float]:
    """A geometric sum, and its slope.

    Σ_{n ≥ 1} (sin πx/π) Δ e^{−n x Δ}, and d log/dx.

    It is (sin πx/πx) xΔ/(e^{xΔ} − 1), and 1 at x = 0.
    """
    if x < 1e-4:  # by series, to rounding
        slope = SPACING**2 / 12.0 - math.pi**2 / 3.0
        return 1.0 - SPACING * x / 2.0, -SPACING / 2.0 + slope * x
    growth = math.expm1(x * SPACING)
    share = math.sin(math.pi * x) / math.pi * SPACING / growth
    climb = math.pi / math.tan(math.pi * x) - SPACING * (growth + 1.0) / growth
    return share, climb


def _build_forms(setting: Setting) -> list[Form]:
    middle = np.sqrt(setting.shortest * setting.duration)  # where share and exponent are untied
    exponent = Parameter("exponent", 0.5, 0.2, low=0.05, high=0.95, starts=(0.25, 0.5, 0.75))
    share = positive("springpot_share", 0.3, per="joint", floor=5e-4)

    def scale(values: Values) -> float:
        a = float(values["exponent"])
        return math.gamma(1 + a) * middle**-a

    def beside(values: Values) -> dict:
        return {
            "springpot_elastic_share": values["springpot_share"] * scale(values),
            "springpot_exponent": values["exponent"],
        }

    def own_compliance(values: Values) -> dict:
        return {
            "springpot_compliance": values["springpot_share"] / setting.stiffness * scale(values),
            "springpot_exponent": values["exponent"],
        }

    def own_time(values: Values) -> dict:
        a, time = float(values["exponent"]), middle / setting.own_time
        return {
            "springpot_elastic_share": values["springpot_share"] * math.gamma(1 + a) * time**-a,
            "springpot_exponent": a,
            "springpot_own_time": 1.0,
        }

    forms = [
        Form("beside", (share, exponent), beside),
        Form("own_compliance", (share, exponent), own_compliance),
        _replace_dashpot(setting),
        build_band(),
    ]
    if setting.trials > 1:
        forms.append(Form("in_own_time", (share, exponent), own_time))
    return [*forms, *build_spectra(setting)]


def _replace_dashpot(setting: Setting) -> Form:
    bent = Parameter(
        "exponent_loss", 0.0, 0.3, low=0.0, high=0.9, amplitude=True, floor=1e-3, starts=(0.003,),
        report={"exponent": lambda loss, _: 1.0 - loss},
    )  # fmt: skip

    def instead(values: Values) -> dict:
        a = 1.0 - max(float(values["exponent_loss"]), LEAST_LOSS)
        rate = math.gamma(1 + a) * (setting.duration / 2) ** (1 - a)
        return {"flow_share": 0.0, "springpot_flow_share": rate, "springpot_exponent": a}

    return Form("instead_of_dashpot", (bent,), instead)


EFFECT = Effect(
    "fractional_creep",
    "creep follows a power of time instead of discrete times",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("modes", scale_flow, ("flow_share",)),
        Hook(
            "modes",
            add_springpot,
            ("springpot_compliance", "springpot_elastic_share", "springpot_flow_share"),
            modes=WITH_LADDER,
        ),
        BAND,
        SPECTRUM,
    ),
    place=CREEP,
)
