"""Declared content of an artifact, and a dataset's faults."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import xarray as xr

Kind = Literal["number", "whole number", "truth value", "text"]
NUMPY_KINDS = {"number": "f", "whole number": "iu", "truth value": "b", "text": "UOT"}


@dataclass(frozen=True)
class Variable:
    """One variable: dimensions, unit, meaning, believed range."""

    dims: tuple[str, ...]
    units: str
    long_name: str
    kind: Kind = "number"
    at_least: float = -np.inf
    at_most: float = np.inf
    optional: bool = False
    compress: bool = False

    def list_faults(self, name: str, array: xr.DataArray) -> Iterator[str]:
        """Sentences on differences from this declaration."""
        if array.dims != self.dims:
            yield f"variable '{name}' has dims {array.dims}; expected {self.dims}"
        if array.size == 0:  # an empty array has lost its type in the file
            return
        if array.dtype.kind not in NUMPY_KINDS[self.kind]:
            yield f"variable '{name}' has the type {array.dtype}; expected {self.kind}s"
        elif self.kind in ("number", "whole number"):
            values = array.to_numpy()
            outside = (values < self.at_least) | (values > self.at_most)
            if outside.any():
                worst = values[outside].flat[0]
                yield (
                    f"variable '{name}' contains {worst:g} {self.units} ("
                    f"{int(outside.sum())} values "
                    f"of {values.size}); expected {self.at_least:g} to {self.at_most:g}"
                )


@dataclass(frozen=True)
class ArtifactSpec:
    """Declared content of an artifact.

    A tree of groups (a fit) declares the variables of each group.

    A group that `optional_groups` names, or of nothing but optional variables, may be missing.
    """

    name: str
    title: str
    rule: str
    variables: Mapping[str, Variable]
    coords: Mapping[str, Variable] = field(default_factory=dict)
    attrs: tuple[str, ...] = ()
    optional_attrs: tuple[str, ...] = ()
    groups: Mapping[str, Mapping[str, Variable]] = field(default_factory=dict)
    optional_groups: frozenset[str] = frozenset()
    version: int = 1


def list_faults(spec: ArtifactSpec, dataset: xr.Dataset) -> list[str]:
    """Faults of a dataset against its artifact.

    A variable or coordinate that the artifact does not declare is a fault too.
    """
    faults = list(_compare(spec.variables, dataset, dataset.data_vars, "variable"))
    faults += _compare(spec.coords, dataset, dataset.coords, "coordinate")
    faults += [f"attribute '{key}' is missing" for key in spec.attrs if key not in dataset.attrs]
    return faults


def list_tree_faults(spec: ArtifactSpec, tree: xr.DataTree) -> list[str]:
    """Faults of a tree of groups.

    More groups and variables than the declared ones are allowed.
    """
    faults = [f"attribute '{key}' is missing" for key in spec.attrs if key not in tree.attrs]
    for group, variables in spec.groups.items():
        if group not in tree.children:
            excused = all(variable.optional for variable in variables.values())
            if not (excused or group in spec.optional_groups):
                faults.append(f"group '{group}' is missing")
            continue
        dataset = tree[group].dataset
        for name, variable in variables.items():
            if name in dataset:
                faults += [
                    f"group '{group}': {f}" for f in variable.list_faults(name, dataset[name])
                ]
            elif not variable.optional:
                faults.append(f"group '{group}': variable '{name}' is missing")
    return faults


def list_unit_faults(declared: Mapping[str, Variable], dataset: xr.Dataset) -> list[str]:
    """Faults of the units that a file states."""
    stated = {name: dataset[name].attrs.get("units") for name in declared if name in dataset}
    return [
        f"variable '{name}' is in {unit}; expected {declared[name].units}"
        for name, unit in stated.items()
        if unit != declared[name].units
    ]


def _compare(
    declared: Mapping[str, Variable], dataset: xr.Dataset, present: Mapping, word: str
) -> Iterator[str]:
    for name, variable in declared.items():
        if name in present:
            yield from variable.list_faults(name, dataset[name])
        elif not variable.optional:
            yield f"{word} '{name}' {variable.dims} [{variable.units}] is missing"
    yield from (f"{word} '{name}' is not declared" for name in present if name not in declared)
