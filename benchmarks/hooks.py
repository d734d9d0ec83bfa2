"""The price of calling physics by address: how much slower the kernel is for a hook more.

A hook that does nothing is put beside the one of an effect, so that the kernel calls one more
wherever it calls that. Simulations with all tangents, CPU time, the least of repeats in turn.

Before effects had hooks, their physics was compiled into the kernel. With stop, gravity, coupling
and inertia called by address instead, all else the same, a simulation took 1 to 4 % longer; the
kernel takes 41 % of a fit of 40 trials, which is 1 to 2 % of the fit.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from benchmarks.forward import FRAMES, TRIALS
from benchmarks.forward import _draw_parameters as draw_parameters
from benchmarks.rivals.equations import GEOMETRY, OFFSET, TENSION
from softfinger.compiled import compiled
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Effect
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import build_slots, build_tangent

REPEATS = 9


@compiled
def add_nothing(model, nodes, balance, i, tangents):  # noqa: ANN001, ANN201
    """An idle hook of kind `balance`."""


@compiled
def bend_nothing(model, j, time, elastic, angle, spring, d_spring, tangents):  # noqa: ANN001, ANN201
    """An idle hook of kind `spring`."""


@compiled
def flow_nothing(model, j, time, torque, drive, row):  # noqa: ANN001, ANN201
    """An idle hook of kind `flow`."""


CASES = {
    "balance": (add_nothing, {"stop_stiffness": 0.5, "stop_angle": 0.3}),
    "spring": (bend_nothing, {"stiffening_square": 2.0}),
    "flow": (flow_nothing, {"yield_torque": 0.02, "yield_width": 0.004}),
}


def measure() -> dict[str, float]:
    """Share of a simulation that one more call costs, at each of the places called most often."""
    return {f"hook_{kind}_share": measure_share(kind, *case) for kind, case in CASES.items()}


def measure_share(kind: str, idle: Callable, values: dict[str, float]) -> float:
    """Time with the idle hook over time without, less one."""
    run = build_run(values)
    hook = Hook(kind, idle, (next(iter(values)),))
    effects = list_effects()
    best = {False: np.inf, True: np.inf}
    for _ in range(REPEATS):
        for extra in best:
            if extra:
                effects["idle"] = Effect(
                    "idle", "nothing", "within_trial", lambda _: "", hooks=(hook,)
                )
            run()  # compiles the first time
            start = time.process_time()
            run()
            best[extra] = min(best[extra], time.process_time() - start)
            effects.pop("idle", None)
    print(f"  {kind}: {1e3 * best[False]:.4g} ms, {1e3 * best[True]:.4g} ms with an idle hook")
    return max(best[True] / best[False] - 1.0, 0.0)  # noise may make it quicker


def build_run(values: dict[str, float]) -> Callable[[], object]:
    """Build the simulation of 100 trials of three joints with some physics, and its tangents."""
    parameters = draw_parameters(np.random.default_rng(1), TRIALS)
    natural = np.stack([*np.log(parameters[:3]), parameters[3]], axis=-1)
    slots = build_slots(TRIALS, 3, values)
    tangents = [build_tangent(TRIALS, 3, {name: 1.0}) for name in values]
    finger, load = describe_finger(GEOMETRY), ([0.0], [OFFSET * TENSION])
    return lambda: simulate_joint_angle_array(natural, slots, tangents, finger, FRAMES, *load)


if __name__ == "__main__":
    print(measure())
