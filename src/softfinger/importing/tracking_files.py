"""SLEAP's analysis HDF5 and `movement`'s NetCDF."""

from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import xarray as xr

from softfinger.faults import Fault
from softfinger.gate.child import Message, read_in_child
from softfinger.importing.faults import ImportFault
from softfinger.importing.table import RawTable


def read_points(path: Path, name: Path) -> list[RawTable]:
    """Read a file of tracked points in a child.

    Each individual becomes a table of points.

    Raises
    ------
    ImportFault
        It cannot be read, or is of another program (:func:`read_hdf5`, :func:`read_netcdf`).
    """
    tables = []
    try:
        for about, content in read_in_child(send_points, str(path), str(name)):
            values = content.view(float).reshape(-1, len(about["columns"]))
            tables.append(
                RawTable(
                    name, about["sheet"], pd.DataFrame(values, columns=about["columns"]),
                    np.arange(len(values)) + 1, about["unit"],
                )
            )  # fmt: skip
    except Fault as fault:
        said = str(fault).removeprefix(f"{name}: ")
        raise ImportFault(f"{name}: {said}") from None
    return tables


def send_points(path: str, name: str) -> Iterator[Message]:
    """Tables of points as messages."""
    for table in READERS[Path(name).suffix.lower()](Path(path), Path(name)):
        columns = list(map(str, table.cells.columns))
        about = {"sheet": table.sheet, "columns": columns, "unit": dict(table.unit)}
        yield about, table.cells.to_numpy(float)


def read_hdf5(path: Path, name: Path) -> list[RawTable]:
    """Read SLEAP's analysis file.

    Each track becomes a table of points.

    Raises
    ------
    ImportFault
        It is no HDF5 file, or one of another program.
    """
    try:
        with h5py.File(path) as file:
            missing = {"tracks", "node_names"} - set(file)
            if missing:
                raise ImportFault(
                    f"{name}: it contains {', '.join(sorted(file))[:80]}; expected SLEAP's "
                    "analysis file with tracks and node_names; from another program, export CSV"
                )
            tracks = np.asarray(file["tracks"])
            nodes = _decode(file["node_names"])
            names = _decode(file["track_names"]) if "track_names" in file else []
            scores = np.asarray(file["point_scores"]) if "point_scores" in file else None
    except OSError as error:
        raise ImportFault(f"{name}: it is not an HDF5 file: {error}") from None
    # As MATLAB has it: (track, axis, node, frame).
    if tracks.ndim == 4 and tracks.shape[1] != 2 and tracks.shape[2] == 2:
        tracks = tracks.swapaxes(1, 2)
    if tracks.ndim != 4 or tracks.shape[1] != 2 or tracks.shape[2] != len(nodes):
        raise ImportFault(
            f"{name}: tracks is {tracks.shape}; expected (track, 2, {len(nodes)} nodes, frame)"
        )
    tables = []
    for k, track in enumerate(tracks):
        trust = None if scores is None else scores[k].T
        label = names[k] if k < len(names) else f"track {k + 1}"
        sheet = label if len(tracks) > 1 else ""
        tables.append(
            _build(name, sheet, np.arange(track.shape[-1]), "frame", track.T, trust, nodes)
        )
    return tables


def _decode(values: h5py.Dataset) -> list[str]:
    return [v.decode() if isinstance(v, bytes) else str(v) for v in np.asarray(values).ravel()]


def read_netcdf(path: Path, name: Path) -> list[RawTable]:
    """Read a dataset of `movement`.

    Each individual becomes a table of points.

    Raises
    ------
    ImportFault
        It is no NetCDF file, or has no ``position`` over time and space.
    """
    try:
        data = xr.load_dataset(path, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError) as error:
        raise ImportFault(f"{name}: it is not a NetCDF-4 file: {error}") from None
    dims = {str(dim).rstrip("s"): str(dim) for dim in data.dims}
    if "position" not in data or "time" not in data.dims or "space" not in data.dims:
        raise ImportFault(
            f"{name}: it contains {', '.join(map(str, data.data_vars))}; expected "
            "movement's position (time, space, keypoints, individuals)"
        )
    for dim in ("keypoint", "individual"):
        if dim not in dims:
            data = data.expand_dims({dim: ["point" if dim == "keypoint" else ""]})
            dims[dim] = dim
    order = (dims["individual"], "time", dims["keypoint"])
    position = data["position"].transpose(*order, "space").sel(space=["x", "y"]).to_numpy()
    trust = data["confidence"].transpose(*order).to_numpy() if "confidence" in data else None
    frames = "frame" in str(data.attrs.get("time_unit", "")) or "time" not in data.coords
    time = data["time"].to_numpy() if "time" in data.coords else np.arange(data.sizes["time"])
    nodes = [str(node) for node in data[dims["keypoint"]].to_numpy()]
    people = [str(person) for person in data[dims["individual"]].to_numpy()]
    return [
        _build(
            name, person if len(people) > 1 else "", time, "frame" if frames else "time",
            position[k], None if trust is None else trust[k], nodes,
        )
        for k, person in enumerate(people)
    ]  # fmt: skip


def _build(
    name: Path, sheet: str, time: np.ndarray, clock: str, position: np.ndarray,
    trust: np.ndarray | None, nodes: list[str],
) -> RawTable:  # fmt: skip
    """Table of points from positions and trust.

    They are ``position (frame, node, axis)`` and ``trust (frame, node)``.
    """
    columns: dict[str, np.ndarray] = {clock: np.asarray(time, float)}
    if position.shape[1:] == (2, len(nodes)):
        position = position.swapaxes(1, 2)
    for k, node in enumerate(nodes):
        columns[f"{node} x"], columns[f"{node} y"] = position[:, k, 0], position[:, k, 1]
        if trust is not None:
            columns[f"{node} score"] = trust[:, k]
    unit = {"time": "s"} if clock == "time" else {}
    return RawTable(name, sheet, pd.DataFrame(columns), np.arange(len(time)) + 1, unit)


READERS: dict[str, Callable[[Path, Path], list[RawTable]]] = {
    ".h5": read_hdf5,
    ".hdf5": read_hdf5,
    ".nc": read_netcdf,
}
