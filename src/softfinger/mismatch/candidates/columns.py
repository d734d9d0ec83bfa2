"""Whitened columns of every form at every start.

They are on top of a fitted model, with one linearisation each.

They serve the score of each form, the bootstrap of the largest score, and masking tables.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials, whiten_slope
from softfinger.mechanics import LOG_PARAMETERS
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.forward.slot import SLOTS
from softfinger.mismatch.candidates.linearised import evaluate_linearised, place_fit

SHIFTS = frozenset(LOG_PARAMETERS)
"""Slots that shift a trial's own parameters."""


class Block(NamedTuple):
    """Amplitudes of one form at one of its starts.

    Attributes
    ----------
    model
        The fitted model with the form added.
    shared
        (p,) where it starts.
    new
        (a,) which numbers of φ the columns belong to.
    added
        How many numbers of φ the form has.
    columns
        (a,) their places among all.
    """

    model: EffectModel
    shared: NDArray[np.float64]
    new: NDArray[np.int64]
    added: int
    columns: NDArray[np.int64]


def join_blocks(one: Block, other: Block) -> Block | None:
    """Join forms on a fitted model, or None."""
    model = one.model.extend(other.model.pieces[-1])
    known = len(other.shared) - other.added
    shared = np.concatenate([one.shared, other.shared[known:]])
    try:
        model.fill_slots(shared)
    except (Fault, ValueError, ArithmeticError):
        return None
    new = np.concatenate([one.new, other.new + len(one.shared) - known])
    columns = np.concatenate([one.columns, other.columns])
    return Block(model, shared, new, one.added + other.added, columns)


class ScoreColumns(NamedTuple):
    """Whitened amplitude columns of every form and start.

    Attributes
    ----------
    blocks
        One for each form and start.
    gram
        (trial, d + p + c + 1, …) of [∂F/∂η | ∂F/∂φ | all columns | residual], η and φ those of the
        fitted model.
    own
        d + p.
    sd
        (c,) prior sd of each column's amplitude.
    positive
        (c,) amplitudes that cannot be negative.
    law
        (c,) terms of free laws, whose size is chosen.
    place
        (c,) number of the place that each column is for, within its form.
    level
        Log evidence [nats] of the fitted model, linearised as the forms are: what it still promises
        where its fit has not come to rest is no form's gain.
    rows
        White rows (row, d + p + c) of each trial, where they were asked for.
    freedom
        Degrees of freedom (row,) of their noise.
    """

    blocks: list[Block]
    gram: NDArray[np.float64]
    own: int
    sd: NDArray[np.float64]
    positive: NDArray[np.bool_]
    law: NDArray[np.bool_]
    place: NDArray[np.int64]
    level: float
    rows: Sequence[NDArray[np.float64]] = ()
    freedom: Sequence[NDArray[np.float64]] = ()

    @property
    def bare(self) -> NDArray[np.float64]:
        """Gram matrices of the columns, residuals excluded.

        (trial, d + c, d + c) of [∂F/∂η | all columns] alone.
        """
        known = self._known
        return np.delete(np.delete(self.gram[:, :-1, :-1], known, axis=1), known, axis=2)

    @property
    def bare_rows(self) -> list[NDArray[np.float64]]:
        """The same columns' rows (row, d + c) of each trial."""
        return [np.delete(rows, self._known, axis=1) for rows in self.rows]

    @property
    def _known(self) -> slice:
        """Columns of the φ that the fitted model has."""
        p = len(self.blocks[0].shared) - self.blocks[0].added if self.blocks else 0
        return np.s_[self.own - p : self.own]

    @property
    def first(self) -> NDArray[np.int64]:
        """Where each block's columns begin (block,)."""
        return np.array([block.columns[0] for block in self.blocks], int)

    @property
    def count(self) -> NDArray[np.int64]:
        """How many columns each block has (block,)."""
        return np.array([len(block.new) for block in self.blocks], int)

    @property
    def label(self) -> list[str]:
        """Id of each block's effect."""
        return [block.model.pieces[-1].effect.id for block in self.blocks]

    def linearise(self, block: Block) -> NDArray[np.float64]:
        """Gram matrices (trial, …) of one block's start.

        They are of [∂F/∂η | ∂F/∂φ | residual].

        Numbers of φ that are no amplitudes have no slope where the effect is all but absent.
        """
        d = self.own - (len(block.shared) - block.added)
        size = d + len(block.shared) + 1
        place = np.full(size, -1)
        place[: self.own] = np.arange(self.own)
        place[d + block.new] = self.own + block.columns
        place[-1] = self.gram.shape[1] - 1
        there = np.flatnonzero(place >= 0)
        gram = np.zeros((len(self.gram), size, size))
        kept = place[there]
        gram[:, there[:, None], there] = self.gram[:, kept[:, None], kept]
        start = np.zeros(size)
        start[d + block.new] = block.shared[block.new]
        moved = gram @ start  # the residual falls by what the start's amplitudes add
        gram[:, -1, -1] += moved @ start - 2.0 * moved[:, -1]
        gram[:, -1, :-1] -= moved[:, :-1]
        gram[:, :-1, -1] -= moved[:, :-1]
        return gram


def collect_columns(
    problem: Problem,
    origin: Candidate,
    pieces: Iterable[Piece],
    freedom: Sequence[NDArray[np.float64]] = (),
) -> ScoreColumns:
    """Collect the whitened columns of all forms.

    At all their starts, on top of a fitted model.

    A start at which a form has no motion is left out.

    Parameters
    ----------
    freedom
        As from `list_freedom`, where draws of noise with tails will need each trial's rows.
    """
    own, known = origin.fit.own, origin.fit.shared
    angle, slope = problem.simulate(origin.model, own, known)
    slopes, blocks, total = [slope], [], 0
    for piece in pieces:
        model = origin.model.extend(piece)
        new = np.flatnonzero(model.amplitudes & (np.arange(len(model.entries)) >= len(known)))
        for start in model.list_starts(len(origin.model.pieces)):
            shared = np.concatenate([known, model.place_start(len(origin.model.pieces), start)])
            null = np.where(np.isin(np.arange(len(shared)), new), 0.0, shared)
            column = (
                _shift_parameters(model, slope[..., : own.shape[1]], null, new)
                if model.name_slots(len(model.pieces) - 1, null) <= SHIFTS
                else _slope_at_null(problem, model, own, (null, shared), new)
            )
            if np.isfinite(column).all():
                slopes.append(column.astype(np.float32))
                place = total + np.arange(len(new))
                blocks.append(Block(model, shared, new, len(shared) - len(known), place))
                total += len(new)
    whole = np.concatenate(slopes, axis=3)
    gram = reduce_trials(problem.trials, angle, whole)
    rows = [whiten_slope(problem.trials, whole, i) for i in range(len(freedom))]
    sd = [block.model.shared_prior[1][block.new] for block in blocks]
    positive = [block.model.low[block.new] == 0.0 for block in blocks]
    law = [block.model.terms[block.new] for block in blocks]
    place = [_number_places(block) for block in blocks]
    return ScoreColumns(
        blocks,
        gram,
        own.shape[1] + len(known),
        np.concatenate([np.zeros(0), *sd]),
        np.concatenate([np.zeros(0, bool), *positive]),
        np.concatenate([np.zeros(0, bool), *law]),
        np.concatenate([np.zeros(0, int), *place]),
        evaluate_linearised(problem, origin.model, place_fit(origin.fit), rounds=0),
        rows,
        freedom,
    )


def _number_places(block: Block) -> NDArray[np.int64]:
    """Number (a,) the places of a form's columns.

    Those without a place count as of one.
    """
    places = [block.model.entries[k].place for k in block.new]
    known = list(dict.fromkeys(places))
    return np.array([known.index(place) for place in places], int)


def _shift_parameters(
    model: EffectModel,
    slope: NDArray[np.float64],
    null: NDArray[np.float64],
    new: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Slopes of what shifts trials' own parameters alone.

    They are (trial, joint, bin · 2, a), and follow from those by η (…, 4 · joint), without a
    simulation.
    """
    tangents = model.fill_tangents(null, new)
    shift = np.stack(
        [np.stack([t.pick(SLOTS[name]) for name in LOG_PARAMETERS], axis=-1) for t in tangents],
        axis=-1,
    )
    return np.einsum("tjnk,tka->tjna", slope, shift.reshape(len(shift), -1, len(tangents)))


def _slope_at_null(
    problem: Problem,
    model: EffectModel,
    own: NDArray[np.float64],
    places: tuple[NDArray[np.float64], NDArray[np.float64]],
    new: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Slopes by a form's amplitudes at their null.

    They are (trial, joint, bin · 2, a). Only there does what alters trials' parameters alone look
    exactly as they do. Where a form has no slope at its null, that of its start, all but absent;
    NaN where neither of the places can be simulated.
    """
    for at in places:
        try:
            slope = problem.simulate(model, own, at, only=new)[1]
        except (ArithmeticError, Fault):
            continue
        if np.isfinite(slope).all() and slope.any(axis=(0, 1, 2)).all():
            return slope
    return np.full(1, np.nan)
