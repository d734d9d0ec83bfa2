"""How surely the oracle could name what was concealed.

No tool can beat this limit.

The evidence gain over the base model measures whether something shows. Whether it can be named is
another question: an effect that moves the angles as another does cannot be named, however strong it
is. So others of the catalogue, in the generator's own forms, are fitted in place of what was
concealed.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from softfinger.concealed.effects import CATALOGUES, Dose, Effect
from softfinger.concealed.judge import VISIBLE_NATS
from softfinger.concealed.oracle import fit_model
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import (
    Setting,
    choose_trials,
    draw_setting,
    record_cleanly,
    set_strengths,
)
from softfinger.concealed.suite import CaseSpec

SCREENED, FEW, MORE = 2, 4, 10  # trials that represent the whole campaign
LARGEST_SCALE = 2.0  # of the whole gain over that of a few trials, before more are taken
FITTED = 3  # that come closest in one step from where they move the angles as far
SIZES = (1.0, 0.1)  # times that, where another effect is tried
ITERATIONS = 10
FIRST_TRY = 0.3  # of the typical strength, at which an effect's size is measured


def weigh_stand_ins(truth: dict) -> dict[str, dict[str, float]]:
    """Evidence [nats] expected for an effect over stand-ins.

    Parameters
    ----------
    truth : dict
        What `generate.compute_truth` wrote.

    Returns
    -------
    dict
        Effect that gains 15 nats → each of the catalogue that comes closest → log Bayes factor:
        the part of the effect's gain that the other does not reach. Both are fitted to some of
        the recordings, free of noise, and get half a nat for each parameter
        (`oracle.expect_gain`). Where a fit of the other stays in a local optimum, it is too large.
    """
    spec = read_spec(truth["case"])
    setting = draw_setting(spec)
    strengths = dict.fromkeys(setting.doses, 0.0)
    strengths |= {e.get("name", e["id"]): e["strength"] for e in truth["effects"]}
    doses = set_strengths(setting.doses, strengths)
    told = {
        e.get("name", e["id"]): e["gain_nats"]
        for e in truth["effects"]
        if e["gain_nats"] >= VISIBLE_NATS
    }
    there = {EFFECTS[name].id for name in doses}
    listed = CATALOGUES[spec.catalogue]
    others = [o for o in listed if o not in there and EFFECTS[o].trials <= spec.trials]
    return {name: _Place(name, doses, setting).weigh(others, gain) for name, gain in told.items()}


def compute_limit(truth: dict, weighed: dict[str, dict[str, float]]) -> float:
    """Probability that the oracle names what was concealed.

    Each effect is as likely beforehand.

    Parameters
    ----------
    weighed
        From `weigh_stand_ins`. Where it is empty, as below 15 nats, nothing in the catalogue is
        taken to come closer than the base model: an upper bound.

    Examples
    --------
    >>> truth = {"case": {}, "gain_nats": 40.0, "effects": [{"id": "gravity", "gain_nats": 40.0}]}
    >>> round(compute_limit(truth, {"gravity": {"moment_arm": 0.0, "inertia": 30.0}}), 3)
    0.5
    """
    if not weighed:
        listed = CATALOGUES[truth["case"].get("catalogue", "first")]
        return 1.0 / (1.0 + len(listed) * _invert(truth["gain_nats"]))
    gains = {e.get("name", e["id"]): e["gain_nats"] for e in truth["effects"]}
    odds = [
        _invert(gains[name]) + sum(_invert(nats) for nats in others.values())
        for name, others in weighed.items()
    ]
    return float(np.prod([1.0 / (1.0 + against) for against in odds]))


def _invert(nats: float) -> float:
    return float(np.exp(-np.clip(nats, -50.0, 50.0)))


def read_spec(case: dict) -> CaseSpec:
    """Return the case that `CaseSpec.to_json` wrote."""
    return CaseSpec(**{key: _freeze(value) for key, value in case.items()})


def _freeze(value: object) -> object:
    return tuple(_freeze(v) for v in value) if isinstance(value, list) else value


class _Place:
    """The place of one concealed effect, open to others."""

    def __init__(self, name: str, doses: dict[str, Dose], setting: Setting) -> None:
        self.name, self.doses, self.setting = name, doses, setting
        self.rest = {other: dose for other, dose in doses.items() if other != name}

    def weigh(self, others: list[str], gain: float) -> dict[str, float]:
        """Log Bayes factor over the closest others.

        The effect gains `gain` nats over the base model.
        """
        between = [o for o in others if EFFECTS[o].level == "between_trials"]
        if EFFECTS[self.name].level != "between_trials":
            # what happens within each trial is not what changes from one to the next
            others, between = [o for o in others if o not in between], []
        screened = {other: self._screen(other) for other in others}
        closest = sorted(others, key=lambda other: -screened[other][0])[:FITTED]
        for few in (MORE,) if between else (FEW, MORE):
            true = self._expect(self.doses, few, iterations=0)
            scale = gain / max(true - self._expect(self.rest, few), 1.0)
            if scale < LARGEST_SCALE:  # these trials show the effect about as well as all do
                break
        return {
            other: scale * (true - self._expect(screened[other][1], few))
            for other in dict.fromkeys([*closest, *between])
        }

    def _screen(self, other: str) -> tuple[float, dict[str, Dose]]:
        """Evidence of another effect in one step.

        It is taken where the other comes closest. The doses that act there are returned too.
        """
        sets = [
            self.rest | {other: replace(dose, strength=size * self._match_size(other, dose))}
            for dose in list_doses(EFFECTS[other], self.doses[self.name], self.setting.rig.joints)
            for size in SIZES
        ]
        evidence = [self._expect(doses, SCREENED, iterations=0) for doses in sets]
        best = int(np.argmax(evidence))
        return evidence[best], sets[best]

    def _expect(self, doses: dict[str, Dose], few: int, iterations: int = ITERATIONS) -> float:
        """Log evidence of effects, from a few trials."""
        count = len(self.setting.trials)
        chosen = choose_trials(count, few)
        fit = fit_model(
            record_cleanly(self.setting, self.doses, chosen),
            self.setting.rig,
            self.setting.noise,
            doses,
            self.setting.individuals[chosen],
            times=count / chosen.size,
            iterations=iterations,
        )
        return fit.log_evidence + 0.5 * fit.solution.effect.size

    def _match_size(self, other: str, dose: Dose) -> float:
        """Strength that moves the last trial as far."""
        last = np.array([len(self.setting.trials) - 1])
        first = FIRST_TRY * EFFECTS[other].typical
        sets = (self.rest, self.doses, self.rest | {other: replace(dose, strength=first)})
        without, seen, tried = (record_cleanly(self.setting, d, last)[0].angle for d in sets)
        size = np.abs(tried - without).max()
        scale = np.abs(seen - without).max() / size if size > 0.0 else 1.0
        largest = EFFECTS[other].largest
        return float(np.clip(first * scale, 1e-3 * largest, largest))


def list_doses(effect: Effect, like: Dose, joints: int) -> list[Dose]:
    """Every choice and place in which effects are exchangeable.

    One effect takes the place of another; the doses have strength zero.

    One that may act on any joints acts on those of the other; one that is tied to a joint or to a
    pair is tried on each.
    """
    free = {key: np.sqrt(s.low * s.high) for key, s in effect.shape.items() if not s.choice}
    choices = {key: (s.low, s.high) for key, s in effect.shape.items() if s.choice}
    places = {
        "chain": [()],
        "first": [(0,)],
        "one": [(j,) for j in range(joints)],
        "pair": [(j, j + 1) for j in range(joints - 1)],
        "any": [like.joints or tuple(range(joints))],
    }[effect.joints]
    return [
        Dose(0.0, free | dict(zip(choices, values, strict=True)), place)
        for place in places
        for values in product(*choices.values())
    ]
