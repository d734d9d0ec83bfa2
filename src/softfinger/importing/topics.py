"""Files that are topics of one recording.

A camera and a load log write one each.
"""

import itertools
import re
from collections.abc import Sequence

from softfinger.importing.table import RawTable
from softfinger.importing.vocabulary import LOAD, MOTION, find_quantity, list_tokens


def group_topics(tables: Sequence[RawTable]) -> dict[str, list[RawTable]]:
    """Tables by recording.

    A recording's tables are in one folder, and their names differ by a quantity's name alone, or
    every number comes with the same words.
    """
    groups = _group_by_stem(tables) or _group_by_number(tables)
    if groups:
        return groups
    for table in tables:
        own = " ".join(_strip_roles(table.file.stem))
        folder = "" if str(table.file.parent) == "." else str(table.file.parent)
        key = " ".join(filter(None, [folder.replace("/", "_"), own]))
        groups.setdefault(key, []).append(table)
    folders = {str(table.file.parent) for table in tables}
    sizes = [len(group) for group in groups.values()]
    if len(folders) > 1 and max(sizes) == 1:
        groups = {}
        for table in tables:
            groups.setdefault(str(table.file.parent).replace("/", "_"), []).append(table)
    return groups


def _group_by_stem(tables: Sequence[RawTable]) -> dict[str, list[RawTable]]:
    """Tables of one name, as ``angles/a.csv, load/a.csv``."""
    groups: dict[str, list[RawTable]] = {}
    for table in tables:
        groups.setdefault(table.file.stem, []).append(table)
    named = all(find_role(table.file.parent.name) for table in tables)
    alone = any(len({t.file.parent for t in group}) < len(group) for group in groups.values())
    return groups if named and not alone and max(map(len, groups.values())) > 1 else {}


def _group_by_number(tables: Sequence[RawTable]) -> dict[str, list[RawTable]]:
    """Tables of one number, as ``camera_1.csv, load_1.csv``."""
    groups: dict[tuple[str, ...], dict[str, RawTable]] = {}
    for table in tables:
        parts = re.split(r"(\d+)", f"{table.file.parent}/{table.file.stem}{table.sheet}")
        words, numbers = "#".join(parts[::2]), tuple(parts[1::2])
        if not numbers or words in groups.setdefault(numbers, {}):
            return {}
        groups[numbers][words] = table
    words = [set(group) for group in groups.values()]
    if len(groups) < 2 or len(words[0]) < 2 or any(own != words[0] for own in words):
        return {}
    named = {_name_shared(list(group.values())): list(group.values()) for group in groups.values()}
    return named if len(named) == len(groups) else {}


def _name_shared(tables: Sequence[RawTable]) -> str:
    """What the paths of all tables share."""
    parts = [re.split(r"[ _/]+", f"{t.file.parent}/{t.file.stem}") for t in tables]
    return " ".join(p for p in parts[0] if p != "." and all(p in other for other in parts))


def _strip_roles(stem: str) -> list[str]:
    plain = re.sub(r"DLC[_-].*", "", stem)  # the network of DeepLabCut
    return [t for t in list_tokens(plain) if find_role(t) is None]


def find_role(name: str) -> str | None:
    """Role that a name alone implies.

    It is ``motion``, ``load`` or none.

    >>> find_role("tendon_force"), find_role("bend angle"), find_role("run3")
    ('load', 'motion', None)
    """
    words = [token for token in list_tokens(name) if len(token) > 2]
    scores = {
        role: max([find_quantity(word, "", words_of)[1] for word in words], default=0.0)
        for role, words_of in (("motion", MOTION), ("load", LOAD))
    }
    best = max(scores, key=lambda role: scores[role])
    return best if scores[best] >= 1.5 else None


def _drop_prefix(stems: list[str]) -> list[str]:
    """Drop what stems begin with alike.

    It is ``video1`` of ``video1_force, video1DLC``.
    """
    pairs = itertools.takewhile(lambda letters: len(set(letters)) == 1, zip(*stems, strict=False))
    length = sum(1 for _ in pairs)
    rest = [stem[length:] for stem in stems]
    whole = all(re.match(r"[ _.\-A-Z]", part) for part in rest)
    return [part.strip(" _.-") for part in rest] if length and whole else stems


def name_topics(tables: Sequence[RawTable]) -> dict[str, RawTable]:
    """Tables by topic, without what all share."""
    if len({t.file.stem for t in tables}) == 1 and len({t.file.parent for t in tables}) > 1:
        return {t.file.parent.name: t for t in tables}
    stems = _drop_prefix([" ".join(filter(None, [t.file.stem, t.sheet])) for t in tables])
    tokens = [re.split(r"[ _.-]+", stem) for stem in stems]
    shared = set.intersection(*map(set, tokens)) if len(tokens) > 1 else set()
    names = ["_".join(t for t in own if t not in shared) or stem
             for own, stem in zip(tokens, stems, strict=True)]  # fmt: skip
    names = [re.sub(r"(?:^|_)\d+(?=_|$)", "", name).strip("_") or name for name in names]
    return dict(zip(names if len(set(names)) == len(names) else stems, tables, strict=True))
