"""A folder of results, opened by artifact name."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import list_specs
from softfinger.artifacts.verdict import read_verdict
from softfinger.faults import Fault

SPECS = {spec.name: spec for spec in list_specs()}


@dataclass(frozen=True)
class Results:
    """What a run has written.

    Attributes
    ----------
    folder : Path
        The folder that ``softfinger run --out`` names.

    Examples
    --------
    >>> results = open_results("my_results")  # doctest: +SKIP
    >>> results["bands"]["joint_angle_mean"].sel(joint=1)  # doctest: +SKIP
    >>> results.verdict["decision"]  # doctest: +SKIP
    """

    folder: Path

    @property
    def names(self) -> list[str]:
        """Names of the artifacts that are there."""
        return [name for name in SPECS if (self.folder / f"{name}.nc").is_file()]

    @property
    def report(self) -> Path:
        """The page that shows them."""
        return self.folder / "report.html"

    @property
    def verdict(self) -> dict[str, Any]:
        """The content of ``verdict.json``."""
        return read_verdict(self.folder / "verdict.json").model_dump(mode="json")

    def __getitem__(self, name: str) -> xr.Dataset | xr.DataTree:
        """Open an artifact, checked against its declaration.

        Raises
        ------
        Fault
            There is none of that name here, or it is not what is declared.
        """
        if name not in self.names:
            found = ", ".join(self.names) or "none"
            raise Fault(f"{self.folder}: no artifact {name!r} is here; there are {found}")
        spec = SPECS[name]
        return (open_tree if spec.groups else open_artifact)(self.folder / f"{name}.nc", spec)


def open_results(folder: Path | str) -> Results:
    """Open a folder of results.

    Raises
    ------
    Fault
        It is no folder, or contains no artifact.
    """
    results = Results(Path(folder))
    if not results.names:
        raise Fault(f"{folder}: no results are here; name the folder that `run --out` was given")
    return results
