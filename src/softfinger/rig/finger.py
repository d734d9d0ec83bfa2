"""The virtual finger behind the simulated controller."""

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.virtual_rig.config import VirtualRigConfig, read_config
from softfinger.virtual_rig.example import EXAMPLE_CONFIG
from softfinger.virtual_rig.population import draw_finger_parameters

_GRID_HZ = 240.0
_HORIZON_S = 10.0  # beyond the last change of the load; afterwards the finger is taken to rest


def build_finger_config() -> VirtualRigConfig:
    """The example campaign's finger and scene."""
    return read_config(EXAMPLE_CONFIG)


class VirtualFinger:
    """A simulated finger, with new parameters each trial."""

    def __init__(self, config: VirtualRigConfig, seed: int) -> None:
        self._geometry = FingerGeometry.uniform(
            config.link_length_m, config.link_mass_kg, config.joint_length_m, config.wire_offset_m
        )
        self._wire_geometry = config.wire_geometry
        self._seed = seed
        self._known: tuple | None = None
        self._time, self._angle = np.zeros(1), np.zeros((1, 1))

    def compute_angle(
        self, trial: int, load_time: NDArray, load_tension: NDArray, time: float
    ) -> NDArray[np.float64]:
        """Joint angles (joint,) [rad] at a time, under load.

        Parameters
        ----------
        trial
            From 0; decides the finger's parameters.
        load_time, load_tension
            (knot,) [s], [N]; may change from call to call from the present on, never in the past.
        time
            [s], on the clock of the load.
        """
        history = (trial, load_time.tobytes(), load_tension.tobytes())
        if history != self._known:
            self._move(trial, load_time, load_tension)
            self._known = history
        return np.array([np.interp(time, self._time, joint) for joint in self._angle])

    def _move(self, trial: int, load_time: NDArray, load_tension: NDArray) -> None:
        drawn = draw_finger_parameters(trial + 1, self._seed).isel(trial=[trial])
        begin, end = load_time[0], load_time[-1] + _HORIZON_S
        self._time = np.arange(begin, end, 1 / _GRID_HZ)
        motion = simulate_full_dynamics(
            drawn, self._geometry, self._time, load_time, load_tension, self._wire_geometry
        )
        self._angle = motion.joint_angle.values[0]
