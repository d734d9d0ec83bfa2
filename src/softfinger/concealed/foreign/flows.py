"""Foreign laws of flow and of the damper."""

import numpy as np

from softfinger.concealed.effects import (
    stress_nonlinear_flow,
    thinning_damper,
    yield_threshold,
)
from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Move
from softfinger.concealed.foreign.law import (
    Curve,
    act_on,
    bend_softly,
    build_law,
    show,
    tabulate_rate,
    tabulate_torque,
)
from softfinger.concealed.physics import Physics


def _flow(curve: Curve) -> dict[str, object]:
    """Build a dashpot whose rate gains s · curve(torque)."""
    row = tabulate_torque(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return physics._replace(flow_law=act_on(dose, row, physics.k_v.size))

    return {"move": move, **show("torque_nm", curve)}


def _yield(share: Curve) -> Move:
    """Build a dashpot that yields.

    It keeps share(torque / threshold) of its rate.
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        if dose.strength <= 0.0:
            return physics
        row = tabulate_torque(lambda torque: share(torque / dose.strength) - 1.0)
        on = Dose(1.0, dose.shape, dose.joints)
        return physics._replace(flow_law=act_on(on, row, physics.k_v.size))

    return move


def _damp(curve: Curve) -> Move:
    """Build a damper: its rate gains s · curve(rate)."""
    row = tabulate_rate(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return physics._replace(damper_law=act_on(dose, row, physics.k_v.size))

    return move


def _share_of_excess(x: Array, power: float) -> Array:
    excess = bend_softly(x - 1.0, 0.05)
    return excess**power / np.maximum(x, 1e-9) ** power * (x > 1e-9)


LAWS = (
    build_law(
        stress_nonlinear_flow.EFFECT,
        "plateau",
        "the rate rises by an S to a second Newtonian branch: sinh and powers have no second one",
        typical=1.0,
        largest=6.0,
        **_flow(lambda t: (t / 0.02) ** 3 / (1.0 + (t / 0.02) ** 3)),
    ),
    build_law(
        stress_nonlinear_flow.EFFECT,
        "logarithm",
        "the rate's gain grows as a logarithm of the torque",
        typical=0.5,
        largest=4.0,
        **_flow(lambda t: np.log1p((np.minimum(t, 10.0) / 0.01) ** 2)),
    ),
    build_law(
        stress_nonlinear_flow.EFFECT,
        "second_slope",
        "beyond a torque a second mechanism flows beside the first, in proportion to the excess",
        typical=1.0,
        largest=8.0,
        **_flow(lambda t: bend_softly(t - 0.02, 0.002) / np.maximum(t, 2e-3)),
    ),
    build_law(
        yield_threshold.EFFECT,
        "casson",
        "flow by (√τ − √τ_y)²: Bingham's is by τ − τ_y",
        move=_yield(lambda x: _share_of_excess(np.sqrt(x), 2.0)),
    ),
    build_law(
        yield_threshold.EFFECT,
        "round_start",
        "flow by τ (1 − τ_y/τ)^1.6, which begins more slowly than Bingham's",
        move=_yield(lambda x: _share_of_excess(x, 1.6)),
    ),
    build_law(
        yield_threshold.EFFECT,
        "two_viscosities",
        "below the threshold it flows too, at a tenth of the rate",
        move=_yield(lambda x: 0.1 + 0.9 * _share_of_excess(x, 1.0)),
    ),
    build_law(
        thinning_damper.EFFECT,
        "carreau",
        "a plateau at slow motion and a power beyond it",
        typical=0.3,
        largest=2.0,
        move=_damp(lambda r: (1.0 + (np.minimum(r, 100.0) / 0.5) ** 2) ** 0.3 - 1.0),
    ),
    build_law(
        thinning_damper.EFFECT,
        "cross",
        "the damper falls to a second constant at fast motion",
        typical=0.5,
        largest=4.0,
        move=_damp(lambda r: r / (r + 0.5)),
    ),
    build_law(
        thinning_damper.EFFECT,
        "step",
        "the damper falls by an S about one rate",
        typical=0.4,
        largest=3.0,
        move=_damp(lambda r: r**3 / (r**3 + 0.3**3)),
    ),
)
