"""Verb `effects`: what an effect declares, in words."""

from __future__ import annotations

import difflib
import inspect
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.demonstration import describe_finger_of_the_paper
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting
from softfinger.mechanics.forward.slot import SLOTS

LEVELS = {
    "within_trial": "within a trial",
    "between_trials": "between trials",
    "measurement": "in the measurement itself",
}
CURVES = {
    "factor": "as the factor 1 + law",
    "exponential": "as the factor e^law",
    "sum": "added",
}


@dataclass(frozen=True)
class DeclaredEffect:
    """What an effect's declarations state.

    Attributes
    ----------
    id, sentence
        As in the verdict.
    shows
        Where it shows.
    place
        Name, unit and meaning of what it changes in the forward model.
    law
        What its free law depends on; None where it has none.
    forms
        Name → names of the parameters, for a campaign that can show everything.
    requires
        What the recordings must have → the effect's own reason.
    helps
        What they may lack → how many forms are left out then.
    about, source
        The words of its module, and the file.
    """

    id: str
    sentence: str
    shows: str
    place: tuple[str, ...]
    law: str | None
    forms: Mapping[str, tuple[str, ...]]
    requires: Mapping[str, str]
    helps: Mapping[str, int]
    about: str
    source: str


def find_effect(name: str) -> Effect:
    """An effect of the catalogue, by its id.

    Raises
    ------
    Fault
        There is none of that id.
    """
    effects = list_effects()
    if name not in effects:
        near = difflib.get_close_matches(name, effects, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(effects)}"
        raise Fault(f"{name!r} is not the id of an effect; {hint}")
    return effects[name]


def describe_effect(effect: Effect) -> DeclaredEffect:
    """Gather what an effect declares."""
    setting = describe_finger_of_the_paper()
    forms = effect.list_forms(setting)
    if isinstance(forms, str):  # an effect of others, for campaigns of another kind
        return _describe(effect, [], {"another campaign": forms}, {})
    requires, helps = {}, {}
    for what, lacking in _list_poorer(setting):
        left = effect.list_forms(lacking)
        if isinstance(left, str):
            requires[what] = left
        elif len(left) < len(forms):
            helps[what] = len(forms) - len(left)
    return _describe(effect, forms, requires, helps)


def _describe(
    effect: Effect, forms: list[Form], requires: dict[str, str], helps: dict[str, int]
) -> DeclaredEffect:
    module = sys.modules[effect.build_forms.__module__]
    filled = {name for form in forms for name in _fill_at_middle(form)}
    moved = [name for name, slot in SLOTS.items() if name in filled and not slot.constant]
    return DeclaredEffect(
        id=effect.id,
        sentence=effect.sentence,
        shows=LEVELS[effect.level],
        place=tuple(f"{n} [{SLOTS[n].unit}]: {SLOTS[n].meaning}" for n in moved),
        law=next((_describe_law(form) for form in forms if form.is_free), None),
        forms={form.name: tuple(p.name for p in form.parameters) for form in forms},
        requires=requires,
        helps=helps,
        about=inspect.cleandoc(module.__doc__ or ""),
        source=module.__file__ or "",
    )


def _describe_law(form: Form) -> str:
    if form.law is not None:
        return f"any smooth curve of {form.law.argument}, {CURVES[form.law.kind]}"
    names = [parameter.name for parameter in form.parameters]
    return f"any values of {', '.join(names)}"


def _fill_at_middle(form: Form) -> dict[str, Any]:
    """Slots that a form fills at its priors."""
    return form.slots({parameter.name: _spread(parameter) for parameter in form.parameters})


def _spread(parameter: Parameter) -> np.ndarray:
    joints = describe_finger_of_the_paper().joints
    shapes = {
        "chain": (),
        "joint": (joints,),
        "pair": (joints, joints),
        "neighbours": (joints, joints),
    }
    value = np.clip(parameter.mean, parameter.low, parameter.high)
    return np.full(shapes[parameter.per], np.exp(value) if parameter.log else value)


def _list_poorer(whole: Setting) -> Iterator[tuple[str, Setting]]:
    """What a campaign may lack, and the rest."""
    yield "a load log", replace(whole, load_known=False, tension=False)
    yield "the wire's tension in the load log", replace(whole, tension=False)
    yield "a load that falls after it has risen", replace(whole, reversals=False, rests=False)
    yield "a load that returns to rest", replace(whole, rests=False)
    yield "several trials", _keep_first_trial(whole)
    yield "several joints", _keep_first_joint(whole)
    yield (
        "the time of each trial (started_at)",
        replace(whole, rest_time=np.full_like(whole.rest_time, np.nan)),
    )
    yield "a covariate in trials.csv", replace(whole, covariates={})
    yield "lengths of links and the wire's offset", replace(whole, geometry=False)
    yield "masses of links", replace(whole, masses=False)
    yield "a camera", replace(whole, camera=False)
    yield "a finger, not a specimen", replace(whole, specimen=True)


def _keep_first_trial(whole: Setting) -> Setting:
    return replace(
        whole,
        trials=1,
        number=whole.number[:1],
        memory=whole.memory[:1],
        largest_torque=whole.largest_torque[:1],
        rest_time=whole.rest_time[:1],
        covariates={name: values[:1] for name, values in whole.covariates.items()},
    )


def _keep_first_joint(whole: Setting) -> Setting:
    return replace(
        whole,
        joints=1,
        stiffness=whole.stiffness[:1],
        reach=whole.reach[:1],
        memory=whole.memory[:, :1],
    )
