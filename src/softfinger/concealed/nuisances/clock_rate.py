"""A camera whose clock has another rate."""

from softfinger.concealed.nuisances.nuisance import Array, Circumstances, Fault, Nuisance, Random


def _clock(time: Array, fault: Fault, trial: Circumstances, rng: Random) -> Array:
    """Frame times t (1 + s) for stated t."""
    return time * (1.0 + fault.size)


NUISANCE = Nuisance(
    id="clock_rate",
    sentence="a clock that runs at another rate",
    finding="clock_rate",
    also=("clock_offset",),
    low=0.0005,
    high=0.002,
    clock=_clock,
    clock_known=True,
)
