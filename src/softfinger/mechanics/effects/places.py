"""The joints, or pairs of joints, that a form is for."""

from collections.abc import Callable, Iterable

from softfinger.mechanics.effects.effect import Parameter, Setting

Places = list[tuple[int, ...]]


def list_places(parameters: Iterable[Parameter], setting: Setting) -> tuple[tuple[int, ...], ...]:
    """All places of a form: joints (j,) or pairs (j, k), 0-based."""
    kinds = {parameter.per for parameter in parameters}
    joints = range(setting.joints)
    if "pair" in kinds:
        return tuple((j, k) for j in joints for k in (j - 1, j + 1) if 0 <= k < setting.joints)
    if "neighbours" in kinds:
        return tuple((j, j + 1) for j in joints[:-1])
    return tuple((j,) for j in joints) if "joint" in kinds else ()


def describe_places(kinds: set[str], *, single: bool) -> tuple[str, Callable[[Places], bool]]:
    """Which joints a form is for: words, test."""

    def is_joints(places: Places) -> bool:
        return len(places) > 0 and all(len(place) == 1 for place in places)

    def is_pairs(places: Places) -> bool:
        return len(places) > 0 and all(len(p) == 2 and abs(p[0] - p[1]) == 1 for p in places)

    if kinds & {"pair", "neighbours"}:
        return "different pairs of neighbouring joints, as [[2, 1]],", is_pairs
    if "joint" in kinds:
        return "different joints", is_joints
    if single:
        return "no joints, [], or a single one", lambda p: not p or (is_joints(p) and len(p) == 1)
    return "no joints, [],", lambda p: not p
