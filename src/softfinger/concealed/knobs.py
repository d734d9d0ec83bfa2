"""The effects' free parameters as one vector."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softfinger.concealed.arrays import Array, Flags
from softfinger.concealed.effects import Dose, Shape
from softfinger.concealed.registry import EFFECTS


@dataclass(frozen=True)
class Knobs:
    """Free parameters of effects, with a normal prior.

    They form one vector φ.

    A strength enters as itself and is not negative, so its prior is half of a normal one. Any other
    parameter is positive and enters as its logarithm.
    """

    doses: dict[str, Dose]
    centre: Array
    sd: Array
    is_strength: Flags

    @property
    def floor(self) -> Array:
        """Least values at which a model is linearised.

        A strength is barely above zero there.
        """
        return np.where(self.is_strength, 1e-4 * self.sd, -np.inf)

    @classmethod
    def of(cls, doses: dict[str, Dose]) -> Knobs:
        """Prior of the effects' free parameters.

        It covers what the generator may have drawn.
        """
        centre, sd, is_strength = [], [], []
        for name in doses:
            effect = EFFECTS[name]
            centre.append(0.0)
            sd.append(0.5 * effect.largest)
            is_strength.append(True)
            for shape in _free_shapes(name).values():
                low, high = np.log(shape.low), np.log(shape.high)
                centre.append(0.5 * (low + high))
                sd.append((high - low) / np.sqrt(12.0))
                is_strength.append(False)
        return cls(doses, np.array(centre), np.array(sd), np.array(is_strength, bool))

    def read(self) -> Array:
        """Vector φ of the present doses."""
        values = []
        for name, dose in self.doses.items():
            values += [dose.strength, *(np.log(dose.shape[key]) for key in _free_shapes(name))]
        return np.array(values)

    def turn(self, vector: Array) -> dict[str, Dose]:
        """Doses of a vector φ."""
        turned, at = {}, 0
        for name, dose in self.doses.items():
            keys = list(_free_shapes(name))
            free = dict(zip(keys, np.exp(vector[at + 1 : at + 1 + len(keys)]), strict=True))
            turned[name] = replace(dose, strength=float(vector[at]), shape={**dose.shape, **free})
            at += 1 + len(keys)
        return turned


def _free_shapes(name: str) -> dict[str, Shape]:
    return {key: s for key, s in EFFECTS[name].shape.items() if not s.choice}
