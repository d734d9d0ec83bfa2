"""What the best model leaves."""

from typing import NamedTuple

import xarray as xr
from scipy.special import expit

from softfinger.inference.problem import Problem
from softfinger.mismatch.checks.free_form import FreeForm
from softfinger.mismatch.checks.lines import Line, find_line
from softfinger.mismatch.checks.slips import Slips, find_slips
from softfinger.mismatch.checks.summary import compute_excess, compute_residual
from softfinger.mismatch.checks.turned import list_turned
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.shape import allow_rest
from softfinger.mismatch.search.stepwise import Search


class Findings(NamedTuple):
    """What is left besides the evidence of listed effects.

    Attributes
    ----------
    excess, p_value
        What lasts within trials of what the best model leaves, over the noise, and its p-value.
    line
        The strongest spectral line that the best model leaves.
    slips
        Slips in single trials that it leaves.
    free
        The best free-form term on top of the best model; None where nothing calls for one.
    gain
        Gain [nats] of the best listed effects over the base model.
    turned
        Effects in the best model that must fall and rise again.
    """

    excess: float
    p_value: float
    line: Line
    slips: Slips
    free: FreeForm | None
    gain: float
    turned: tuple[str, ...] = ()

    @property
    def left(self) -> float:
        """Evidence [nats] for what the effects leave."""
        free = 0.0 if self.free is None else self.free.gain
        return max(free, self.line.gain, self.slips.gain)

    def is_unlisted(self, needed: float) -> bool:
        """Whether too much is left, or an effect turned back."""
        left = self.p_value < DECISIONS.missing or self.left > allow_rest(self.gain, needed)
        return bool(left or self.turned)


def examine(problem: Problem, search: Search, angles: xr.Dataset, *, needed: float) -> Findings:
    """Examine what the best model leaves.

    Scatter, a line, a shape.

    The search must come from `shape_rest`.
    """
    time = angles.sel(trial=problem.trials.name)["time"].transpose("trial", "frame").values
    line = find_line(problem, compute_residual(problem, search.best, angles), time)
    free = search.shape.free
    free = free if free is not None and free.gain > needed else None
    gain = search.best.log_evidence - search.base.log_evidence
    slips = find_slips(problem, search.best, angles)
    excess = compute_excess(problem, search.best)
    turned = tuple(list_turned(problem, search.best))
    return Findings(*excess, line, slips, free, gain, turned)


def weigh_against_shape(search: Search, findings: Findings) -> float:
    """Probability of the best effects against a shape.

    The effects are missing with a rest, and not a shape alone.

    Effects may seem present that only imitate what no effect explains. A free-form term on top
    of the base model takes it without them; both have prior ½.
    """
    shape = search.base.log_evidence + search.alone.gain
    rest = 0.0 if findings.free is None else findings.free.gain
    return float(expit(search.best.log_evidence + rest - shape))
