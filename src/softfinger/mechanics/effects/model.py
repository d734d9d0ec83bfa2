"""A set of effects as one vector φ."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting
from softfinger.mechanics.forward.slots import SLOTS, SlotArrays, build_slots, build_tangent

DIFFERENCE = 1e-5  # of a parameter's prior sd, to differentiate slots by it
LONGEST_STEP = 1.0  # of a parameter's prior sd, in one linearisation


@dataclass(frozen=True, eq=False)
class Piece:
    """One effect in one form, at some places.

    Places are joints (j,) or pairs (j, k), 0-based. The prior sds of a law's terms are `size` times
    those of the form.
    """

    effect: Effect
    form: Form
    places: tuple[tuple[int, ...], ...]
    size: float = 1.0

    @property
    def label(self) -> str:
        """Effect, form and places in one word."""
        places = ",".join("".join(str(j + 1) for j in place) for place in self.places)
        return f"{self.effect.id}/{self.form.name}/{places}".rstrip("/")

    @property
    def joints(self) -> list[int]:
        """Its joints, counted from 1."""
        return sorted({joint + 1 for place in self.places for joint in place})


@dataclass(frozen=True, eq=False)
class Entry:
    """One number of φ: its piece, parameter, place."""

    piece: int
    parameter: Parameter
    place: tuple[int, ...]

    @property
    def suffix(self) -> str:
        """Joint or pair, from 1; chain: empty."""
        return "_" + "".join(str(j + 1) for j in self.place) if self.place else ""

    @property
    def name(self) -> str:
        """The parameter's name with its joint or pair."""
        return self.parameter.name + self.suffix

    def report(self, values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Convert internal values to a verdict's.

        Values (n,) come back by the names that the verdict gives them.

        A term of a free law is given by its curve alone.
        """
        if self.parameter.term:
            return {}
        physical = np.exp(values) if self.parameter.log else values
        joint = self.place[0] if self.place else -1
        return {
            name + self.suffix: np.array([convert(float(value), joint) for value in physical])
            for name, convert in self.parameter.report.items()
        } or {self.name: physical}


Known = Mapping[tuple[str, str], tuple[float, float]]
"""(effect id, name of a number of φ) → mean and sd on the internal scale."""


@dataclass(frozen=True, eq=False)
class EffectModel:
    """The base model and a set of effects.

    Attributes
    ----------
    setting
        The campaign that it is for.
    pieces
        Its effects.
    known
        Priors that replace those of the catalogue.
    """

    setting: Setting
    pieces: tuple[Piece, ...] = ()
    known: Known = field(default_factory=dict)

    @property
    def ids(self) -> frozenset[str]:
        """The ids of its effects."""
        return frozenset(piece.effect.id for piece in self.pieces)

    @property
    def label(self) -> str:
        """All pieces in one line."""
        return " + ".join(piece.label for piece in self.pieces) or "base"

    def without(self, entry: Entry) -> "EffectModel":
        """Build the model without an amplitude's place."""
        piece = self.pieces[entry.piece]
        places = tuple(place for place in piece.places if place != entry.place)
        pieces = list(self.pieces)
        if entry.place and places:
            pieces[entry.piece] = replace(piece, places=places)
        else:
            del pieces[entry.piece]
        return replace(self, pieces=tuple(pieces))

    def match(self, other: "EffectModel") -> NDArray[np.int64]:
        """Where a smaller model's entries are in φ."""
        mine = [(self.pieces[e.piece].effect.id, e.name) for e in self.entries]
        return np.array(
            [mine.index((other.pieces[e.piece].effect.id, e.name)) for e in other.entries], int
        )

    def extend(self, piece: Piece) -> "EffectModel":
        """Build the model with one more piece."""
        return replace(self, pieces=(*self.pieces, piece))

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Every number of φ, in order."""
        entries = []
        for number, piece in enumerate(self.pieces):
            for parameter in piece.form.parameters:
                places = [()] if parameter.per == "chain" else piece.places
                entries += [Entry(number, parameter, place) for place in places]
        return tuple(entries)

    @cached_property
    def shared_prior(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Prior mean and sd of φ, internal."""
        size = np.array([self.pieces[entry.piece].size for entry in self.entries], float)
        sized = np.where(self.terms, size, 1.0)
        usual = np.stack([self._gather("mean"), self._gather("sd") * sized])
        for k, entry in enumerate(self.entries):
            key = self.pieces[entry.piece].effect.id, entry.name
            usual[:, k] = self.known.get(key, usual[:, k])
        usual.flags.writeable = False  # it is kept
        return usual[0], usual[1]

    @cached_property
    def low(self) -> NDArray[np.float64]:
        """Lower bounds of φ."""
        return self._gather("low")

    @cached_property
    def high(self) -> NDArray[np.float64]:
        """Upper bounds of φ."""
        return self._gather("high")

    @cached_property
    def terms(self) -> NDArray[np.bool_]:
        """Which numbers of φ are terms of a law."""
        return np.array(
            [bool(self.pieces[e.piece].form.law) and e.parameter.term for e in self.entries], bool
        )

    @cached_property
    def amplitudes(self) -> NDArray[np.bool_]:
        """Which numbers of φ are amplitudes."""
        return np.array([e.parameter.amplitude for e in self.entries], bool)

    def _gather(self, attribute: str) -> NDArray[np.float64]:
        found = np.array([getattr(e.parameter, attribute) for e in self.entries], float)
        found.flags.writeable = False  # it is kept
        return found

    def list_negligible(self, shared: NDArray[np.float64]) -> frozenset[str]:
        """Effects with amplitudes in φ (p,) below floors."""
        mine = [e for e in self.entries if e.parameter.amplitude]
        claimed = {
            e.piece
            for e, value in zip(mine, shared[self.amplitudes], strict=True)
            if abs(value) >= e.parameter.floor
        }
        pieces = enumerate(self.pieces)
        return frozenset(piece.effect.id for k, piece in pieces if k not in claimed)

    def list_starts(self, piece: int) -> list[dict[str, float]]:
        """Every combination of a piece's starts, internal."""
        parameters = self.pieces[piece].form.parameters
        choices = [p.starts or (p.mean,) for p in parameters]
        names = [p.name for p in parameters]
        return [dict(zip(names, values, strict=True)) for values in product(*choices)]

    def place_start(self, piece: int, start: Mapping[str, float]) -> NDArray[np.float64]:
        """Values of a piece's entries at a start."""
        mine = [entry for entry in self.entries if entry.piece == piece]
        return np.array([start[entry.parameter.name] for entry in mine])

    def name_slots(self, piece: int, shared: NDArray[np.float64]) -> frozenset[str]:
        """Names of the slots that a piece fills."""
        return frozenset(self.pieces[piece].form.slots(self._physical(piece, shared)))

    def fill_slots(self, shared: NDArray[np.float64]) -> SlotArrays:
        """Fill all trials' slots from φ (p,)."""
        values: dict[str, NDArray] = {}
        for number in range(len(self.pieces)):
            for name, value in self.fill_piece(number, shared).items():
                if name in values and SLOTS[name].null != 0.0:
                    raise Fault(f"{self.label}: two effects claim the slot {name}")
                values[name] = values[name] + value if name in values else value
        return build_slots(self.setting.trials, self.setting.joints, values)

    def fill_tangents(
        self, shared: NDArray[np.float64], only: NDArray[np.int64] | None = None
    ) -> list[SlotArrays]:
        """Differentiate slots by φ, or `only` some, centrally."""
        tangents = []
        for k in range(len(shared)) if only is None else only:
            entry, tangent = self.entries[k], self._constant_tangents.get(k)
            if tangent is None:
                tangent = self._differentiate(k, shared)
            if entry.parameter.term and self.pieces[entry.piece].form.linear:
                self._constant_tangents[k] = tangent
            tangents.append(tangent)
        return tangents

    def _differentiate(self, k: int, shared: NDArray[np.float64]) -> SlotArrays:
        number, step = self.entries[k].piece, DIFFERENCE * self.entries[k].parameter.sd
        up, down = shared.copy(), shared.copy()
        up[k], down[k] = shared[k] + step, shared[k] - step
        up, down = self.fill_piece(number, up), self.fill_piece(number, down)
        slope = {
            name: (np.asarray(up[name]) - down[name]) / (2.0 * step)
            for name in up
            if not SLOTS[name].constant
        }
        return build_tangent(self.setting.trials, self.setting.joints, slope)

    @cached_property
    def _constant_tangents(self) -> dict[int, SlotArrays]:
        """Known tangents by φ in which slots are linear."""
        return {}

    def fill_piece(self, number: int, shared: NDArray[np.float64]) -> dict[str, NDArray]:
        """Slots of one piece, null in joints without it."""
        piece = self.pieces[number]
        filled = self._confine(piece, piece.form.slots(self._physical(number, shared)))
        if not all(np.isfinite(value).all() for value in filled.values()):
            raise ArithmeticError(f"{self.label}: a slot is not finite at {shared}")
        return filled

    def _confine(self, piece: Piece, filled: Mapping[str, NDArray]) -> dict[str, NDArray]:
        """Slots, null in joints without the effect."""
        if not (piece.form.local and piece.places):
            return dict(filled)
        here = np.isin(np.arange(self.setting.joints), [place[0] for place in piece.places])
        return {
            name: np.where(
                here[:, None] if SLOTS[name].kind == "law" else here, value, SLOTS[name].null
            )
            for name, value in filled.items()
        }

    def _physical(self, piece: int, shared: NDArray[np.float64]) -> dict[str, NDArray]:
        blank, mine = self._layouts[piece]
        values = {name: np.full(shape, fill) for name, (shape, fill) in blank.items()}
        for k, name, place, is_log in mine:
            values[name][place] = np.exp(shared[k]) if is_log else shared[k]
        return values

    @cached_property
    def _layouts(self) -> list[tuple[dict, list]]:
        """Each piece's empty parameters, and places in φ."""
        joints = self.setting.joints
        pairs = (joints, joints)
        empty = {"chain": (), "joint": (joints,), "pair": pairs, "neighbours": pairs}
        layouts: list[tuple[dict, list]] = []
        for piece in self.pieces:
            blank = {}
            for p in piece.form.parameters:
                fill = 0.0 if p.amplitude else float(np.exp(p.mean * p.log))
                blank[p.name] = empty[p.per], fill
            layouts.append((blank, []))
        for k, entry in enumerate(self.entries):
            name, is_log = entry.parameter.name, entry.parameter.log
            layouts[entry.piece][1].append((k, name, entry.place, is_log))
        return layouts
