"""A free spectrum of retardation times: the law of creep in time, whatever its shape.

One narrow peak is a second retardation, a broad band a power of time. So the effects of creep share
this form, and the shape shows which of them it is.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import FREE, Form, Setting, Values, positive
from softfinger.mechanics.forward.curve import KNOTS, combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import LADDER, RATES, SPACING, WITH_LADDER
from softfinger.mechanics.forward.slot import LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

CREEP = "creep"
"""The place of all effects that are creep in time."""
PLACES_PER_DECADE = 2  # of the spectrum, even in the logarithm of time
FEWEST_PLACES, MOST_PLACES = 6, 12
SIZE = 1.0  # prior scale of the spectrum's whole compliance, as a share of 1/k_v


_SPECTRUM, _SHORTEST, _LONGEST, _OWN = declare(
    spectrum=Slot(
        "law", "1", 0.0, "compliance for each e-fold of retardation time, as a share of 1/k_v"
    ),
    spectrum_shortest=Slot(
        "joint", "s", 0.1, "time at which that law begins", "positive", constant=True
    ),
    spectrum_longest=Slot(
        "joint", "s", 10.0, "time at which that law ends", "positive", constant=True
    ),
    spectrum_own_time=Slot(
        "joint", "1", 0.0, "1: those times are in units of the joint's c_v/k_v", constant=True
    ),
)


@compiled
def add_spectrum(model: Model, linear: Linear, j: int) -> None:
    """Elements at the ladder's rates, of the spectrum's compliance there."""
    value, own = model.joint[j], model.joint[j, _OWN]
    soft = math.exp(-value[LOG_K_V])
    longer = own * (value[LOG_C_V] - value[LOG_K_V])  # log of the unit of time
    span = math.log(value[_LONGEST] / value[_SHORTEST])
    for step in range(RATES.size):
        x = -(math.log(RATES[step] * value[_SHORTEST]) + longer) / span
        if not 0.0 <= x <= 1.0:
            continue
        weights, unit = weigh_value(x), soft * SPACING * RATES[step]
        gain = unit * combine(model.law[j, _SPECTRUM], weights)
        steep = unit * combine(model.law[j, _SPECTRUM], weigh_slope(x)) * own / span
        linear.gain[j, LADDER + step] += gain
        for c in model.columns[j]:
            moved = model.d_joint[c, j]
            change = unit * combine(model.d_law[c, j, _SPECTRUM], weights)
            change -= gain * moved[LOG_K_V] + steep * (moved[LOG_C_V] - moved[LOG_K_V])
            linear.d_gain[j, LADDER + step, c] += change


SPECTRUM = Hook("modes", add_spectrum, ("spectrum",), modes=WITH_LADDER)


def build_spectra(setting: Setting) -> list[Form]:
    """Build the free forms: in seconds, and where there are several trials in each trial's time."""
    alone = setting.trials == 1
    return [build_spectrum(setting, own_time=own) for own in ((False,) if alone else (False, True))]


def build_spectrum(setting: Setting, *, own_time: bool = False) -> Form:
    """Build the free form, between two frames and twice the longest trial.

    With `own_time` all times are those of a trial in which c_v/k_v is the median, and follow each
    trial's own: trials may creep alike, each at its own pace. There it is zero at both ends, as
    they pass over the ladder's rates.
    """
    shortest, longest = 2 * setting.shortest, 2 * setting.duration
    decades = float(np.log10(longest / shortest))
    places = int(np.clip(round(PLACES_PER_DECADE * decades), FEWEST_PLACES, MOST_PLACES))
    size = SIZE / np.log(longest / shortest)
    heights = tuple(
        positive(f"compliance_share_at_{k}", size, per="joint", floor=2e-3 * size, term=True)
        for k in range(1, places + 1)
    )
    ends = 2.0 if own_time else 0.0  # places beyond the first and the last, of no compliance
    between_places = np.linspace(-ends / 2.0, places - 1.0 + ends / 2.0, KNOTS)
    hats = np.maximum(0.0, 1.0 - np.abs(between_places - np.arange(places)[:, None]))
    unit = setting.own_time if own_time else 1.0
    reach = {"spectrum_shortest": shortest / unit, "spectrum_longest": longest / unit}

    def spectrum(values: Values) -> dict:
        stacked = np.stack([np.asarray(values[p.name]) for p in heights], axis=-1)
        return {"spectrum": stacked @ hats, "spectrum_own_time": float(own_time), **reach}

    name = f"{FREE}_in_own_time" if own_time else FREE
    return Form(name, heights, spectrum, kin=CREEP, linear=True)
