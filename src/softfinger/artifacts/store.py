"""Save and open artifacts: the only NetCDF code."""

import glob
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import xarray as xr

from softfinger.artifacts.checksum import append_checksum, is_whole
from softfinger.artifacts.spec import (
    ArtifactSpec,
    Variable,
    list_faults,
    list_tree_faults,
    list_unit_faults,
)
from softfinger.faults import ArtifactFault, Fault
from softfinger.processes import is_running
from softfinger.provenance import Provenance

ENGINE = "h5netcdf"
COMPRESSION = {"zlib": True, "complevel": 4, "shuffle": True}


@contextmanager
def write_atomically(path: Path | str) -> Iterator[Path]:
    """Yield a temporary name that becomes ``path``.

    It is beside ``path`` and replaces it only when all went well.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        raise Fault(f"{path}: is a folder, and a file of this name is to be written; move it away")
    _remove_left_over(path)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _remove_left_over(path: Path) -> None:
    """Remove files that killed writers of this left."""
    start, end = f".{path.stem}.", f".partial{path.suffix}"
    for left in path.parent.glob(f"{glob.escape(start)}*{glob.escape(end)}"):
        writer = left.name.removeprefix(start).removesuffix(end)
        if writer.isdigit() and not is_running(int(writer)):
            left.unlink(missing_ok=True)


def save_artifact(
    dataset: xr.Dataset, spec: ArtifactSpec, path: Path | str, provenance: Provenance
) -> None:
    """Validate, stamp and write a dataset, whole or not.

    The stamps are units, meaning and provenance.

    Units are set from the spec, never trusted from the arrays: arithmetic carries them on wrongly.

    Raises
    ------
    ArtifactFault
        The dataset is not what the spec declares; all faults are listed.
    """
    _refuse(str(path), list_faults(spec, dataset))
    declared = {**spec.variables, **spec.coords}
    stamped = _stamp(dataset, declared)
    kept = [*spec.attrs, *(key for key in spec.optional_attrs if key in dataset.attrs)]
    stamped.attrs = {key: dataset.attrs[key] for key in kept} | _root_attrs(spec, provenance)
    encoding = {
        name: COMPRESSION if declared[name].compress else {}
        for name in stamped.variables
        if declared[name].kind != "text"
    }
    with write_atomically(path) as temporary:
        # In memory first: HDF5 ends in a segmentation fault where a disk is full.
        temporary.write_bytes(stamped.to_netcdf(engine=ENGINE, encoding=encoding))
        append_checksum(temporary)


def save_tree(
    tree: xr.DataTree, spec: ArtifactSpec, path: Path | str, provenance: Provenance
) -> None:
    """Validate and write a tree of ArviZ groups.

    It works like :func:`save_artifact`.

    Raises
    ------
    ArtifactFault
        A declared group or variable is missing or wrong; all faults are listed.
    """
    _refuse(str(path), list_tree_faults(spec, tree))
    stamped = tree.map_over_datasets(_drop_machine_attrs)
    for group in [name for name in spec.groups if name in tree.children]:
        stamped[group].dataset = _stamp(stamped[group].to_dataset(), spec.groups[group])
    stamped.attrs = {key: tree.attrs[key] for key in spec.attrs} | _root_attrs(spec, provenance)
    with write_atomically(path) as temporary:
        temporary.write_bytes(stamped.to_netcdf(engine=ENGINE))
        append_checksum(temporary)


def open_artifact(path: Path | str, spec: ArtifactSpec) -> xr.Dataset:
    """Load an artifact into memory.

    Raises
    ------
    ArtifactFault
        The file is missing, damaged, or not this artifact; all faults are listed.
    """
    dataset = _load(Path(path), xr.load_dataset)
    faults = [*_list_schema_faults(spec, dataset.attrs), *list_faults(spec, dataset)]
    faults += list_unit_faults({**spec.variables, **spec.coords}, dataset)
    _refuse(str(path), faults)
    return dataset


def open_tree(path: Path | str, spec: ArtifactSpec) -> xr.DataTree:
    """Load a tree of groups into memory.

    Raises
    ------
    ArtifactFault
        As :func:`open_artifact`.
    """
    tree = _load(Path(path), xr.load_datatree)
    faults = [*_list_schema_faults(spec, tree.attrs), *list_tree_faults(spec, tree)]
    for group in [name for name in spec.groups if name in tree.children]:
        faults += list_unit_faults(spec.groups[group], tree[group].dataset)
    _refuse(str(path), faults)
    return tree


def _load[Content](path: Path, load: Callable[..., Content]) -> Content:
    if not path.is_file():
        raise ArtifactFault(str(path), ["the file does not exist; run the rule that makes it"])
    if not is_whole(path):
        message = (
            "it does not end in the checksum of its content: it is damaged, cut off, or no "
            "artifact as softfinger wrote it; delete it and make it again"
        )
        raise ArtifactFault(str(path), [message])
    try:
        return load(path, engine=ENGINE)
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        message = f"it is not a complete NetCDF file ({reason}); delete it and make it again"
        raise ArtifactFault(str(path), [message]) from None


def _list_schema_faults(spec: ArtifactSpec, attrs: Mapping) -> list[str]:
    faults = []
    if attrs.get("schema") != spec.name:
        faults.append(f"attribute 'schema' is {attrs.get('schema')!r}; expected '{spec.name}'")
    if attrs.get("schema_version") != spec.version:
        found = attrs.get("schema_version")
        faults.append(f"attribute 'schema_version' is {found}; this program reads {spec.version}")
    return faults


def _refuse(place: str, faults: list[str]) -> None:
    if faults:
        raise ArtifactFault(place, faults)


def _stamp(dataset: xr.Dataset, declared: Mapping[str, Variable]) -> xr.Dataset:
    stamped = dataset.copy()
    for name in stamped.variables:
        stamped[name].encoding = {}
        if name in declared:
            variable = declared[str(name)]
            stamped[name].attrs = {"units": variable.units, "long_name": variable.long_name}
    return stamped


def _root_attrs(spec: ArtifactSpec, provenance: Provenance) -> dict[str, str | int]:
    schema = {"title": spec.title, "schema": spec.name, "schema_version": spec.version}
    return schema | provenance.to_attrs()


def _drop_machine_attrs(dataset: xr.Dataset) -> xr.Dataset:
    # ArviZ and the samplers note clocks, durations and versions: not ours to keep.
    clean = dataset.copy()
    clean.attrs = {}
    return clean
