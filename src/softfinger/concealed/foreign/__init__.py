"""Foreign laws, which no textbook form contains."""

from softfinger.concealed.effects.effect import Effect
from softfinger.concealed.foreign import (
    chains,
    drives,
    flows,
    optics,
    spectra,
    springs,
    trials,
    wires,
)

FOREIGN: dict[str, Effect] = {
    f"{law.id}/{law.law}": law
    for module in (springs, flows, wires, spectra, drives, chains, optics, trials)
    for law in module.LAWS
}

__all__ = ["FOREIGN"]
