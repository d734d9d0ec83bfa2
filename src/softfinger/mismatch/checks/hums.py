"""Hums: waves that go on whatever the load does.

A trial's residual contains a cos ωt + b sin ωt, a and b normal of sd s, one size for all trials and
free in each. Its rival is physics, which follows the load (`driven`). A wave above the rest is a
hum where that has at least as much evidence, averaged over sizes; it pays for the choice among
frequencies and joints. The first wave that follows the load ends the search: what physics leaves
beside it is not known before it is in the model.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

from softfinger.inference.problem import Candidate, Problem
from softfinger.measurement.decisions import DECISIONS as MEASUREMENT
from softfinger.measurement.measure import add_components
from softfinger.mechanics.effects.measurement_file import HumEntry
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.checks.driven import weigh_driven
from softfinger.mismatch.checks.lines import (
    WaveSeries,
    list_frequencies,
    list_series,
    list_shapes,
    scan_series,
)
from softfinger.mismatch.checks.summary import compute_residual
from softfinger.mismatch.checks.waves import (
    Array,
    Wave,
    average_evidence,
    estimate_wave,
    project_wave,
    weigh_wave,
)
from softfinger.mismatch.priors import PRIORS


class Hum(NamedTuple):
    """A wave that goes on whatever the load does.

    Attributes
    ----------
    frequency_hz
        Its frequency.
    size
        Sd [rad] of its cosine's and its sine's amplitude.
    evidence
        [nats] for it.
    amplitude
        (trial, joint) a − ib [rad], most probable, of a cos ωt + b sin ωt.
    """

    frequency_hz: float
    size: float
    evidence: float
    amplitude: Wave

    def move(self, time: Array) -> Array:
        """Angles (trial, joint, frame) [rad] at (trial, frame) [s]."""
        return (self.amplitude[:, :, None] * _sound(time, self.frequency_hz)[:, None]).real


def hear_hums(problem: Problem, candidate: Candidate, angles: xr.Dataset) -> list[Hum]:
    """Find the hums that a model leaves in recordings."""
    time = angles.sel(trial=problem.trials.name)["time"].transpose("trial", "frame").values
    return find_hums(problem, compute_residual(problem, candidate, angles), time)


def describe_hums(hums: list[Hum], trials: list[str]) -> list[HumEntry]:
    """Describe hums of some trials, as in a model file."""
    return [
        HumEntry(
            frequency_hz=hum.frequency_hz,
            cosine_rad=dict(zip(trials, hum.amplitude.real.tolist(), strict=True)),
            sine_rad=dict(zip(trials, (-hum.amplitude.imag).tolist(), strict=True)),
        )
        for hum in hums
    ]


def note_hums(measurement: xr.Dataset, hums: list[Hum]) -> xr.Dataset:
    """Add hums to what a campaign's recordings suffer from."""
    if hums:
        size = float(np.sqrt(sum(hum.size**2 for hum in hums)))
        evidence = sum(hum.evidence for hum in hums)
        measurement = add_components(measurement, {"hum": size}, {"hum": evidence})
    return measurement.assign(hum_frequency=("hum", np.array([h.frequency_hz for h in hums])))


def find_hums(problem: Problem, residual: Array, time: Array) -> list[Hum]:
    """Find one hum after the other.

    Each is sought in what those before it leave.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad], NaN where not used.
    time
        (trial, frame) [s].
    """
    hums: list[Hum] = []
    while len(hums) < BUDGET.hums:
        hum = _find_hum(problem, residual, time)
        if hum is None:
            break
        hums.append(hum)
        residual = residual - hum.move(time)
    return hums


def _find_hum(problem: Problem, residual: Array, time: Array) -> Hum | None:
    """Find the strongest wave, if it is a hum."""
    frequencies = list_frequencies(problem)
    every = list_series(problem, residual, time)
    gain = scan_series(every, frequencies)[1].max(axis=0)
    shape, place = np.unravel_index(gain.argmax(), gain.shape)
    series, cost = every[shape], float(np.log(gain.size))
    if gain[shape, place] < MEASUREMENT.present_nats:
        return None
    frequency = _tune(series, frequencies, int(place))
    sizes = np.array(PRIORS.hum_sizes) / np.median([one.per_rad for one in series])
    products = project_wave(series, [_sound(one.time, frequency) for one in series])
    each = weigh_wave(products, sizes)
    evidence = average_evidence(each) - cost
    if evidence < MEASUREMENT.present_nats:
        return None
    if evidence < weigh_driven(problem, series, (frequency, cost), sizes):
        return None
    amplitude, size = estimate_wave(products, float(sizes[each.argmax()]))
    known = np.zeros(residual.shape[:2], complex)
    joints = list_shapes(problem.setting.stiffness)[shape]
    known[[one.trial for one in series]] = np.outer(amplitude, joints)
    return Hum(frequency, size, evidence, known)


def _sound(time: Array, frequency: float) -> Wave:
    """Cosine and sine of a frequency [Hz] at times."""
    return np.exp(2j * np.pi * frequency * time)


def _tune(series: list[WaveSeries], frequencies: Array, place: int) -> float:
    """Frequency [Hz] of most power near a grid's."""
    step = frequencies[min(1, len(frequencies) - 1)] - frequencies[0]
    if step == 0.0:
        return float(frequencies[place])

    def lack(frequency: float) -> float:
        return -sum(abs(one.values @ _sound(one.time, frequency)) ** 2 for one in series)

    slowest = frequencies[0] / 2.0  # what is slower is a drift
    near = frequencies[place] + np.linspace(-step, step, BUDGET.hum_tries)
    near = near[near >= slowest]
    best = near[np.argmin([lack(f) for f in near])]
    apart = near[1] - near[0]
    bounds = max(best - apart, slowest), best + apart
    return float(minimize_scalar(lack, bounds=bounds, method="bounded").x)
