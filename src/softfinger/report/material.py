"""The artifacts of one campaign for its report."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.figures.style import get_motion_unit, label_load_unit

Artifact = xr.Dataset | xr.DataTree | Mapping[str, Any]
NEEDED = ("angles", "checks", "summary")


@dataclass(frozen=True)
class Material:
    """The artifacts of one campaign.

    Everything but ``NEEDED`` may be missing.
    """

    artifacts: Mapping[str, Artifact]
    config: Mapping[str, Any]
    commit: str | None = None

    def __post_init__(self) -> None:
        """Refuse a report without recordings or without summary."""
        for name in NEEDED:
            if name not in self.artifacts:
                rule = "angles" if name == "angles" else "summarise"
                raise Fault(f"the report needs the artifact '{name}'; run the rule {rule} first")

    def __contains__(self, name: str) -> bool:
        """Whether an artifact is there."""
        return self.artifacts.get(name) is not None

    def get(self, name: str) -> xr.Dataset:
        """Return an artifact, stamped with the campaign's source."""
        return self.artifacts[name].assign_attrs(source=self.source)

    def find(self, group: str) -> xr.Dataset | None:
        """A stamped group of `checks` or `summary`.

        None where it was not made.
        """
        for name in ("checks", "summary"):
            tree = self.artifacts[name]
            if group in tree.children:
                return tree[group].to_dataset().assign_attrs(source=self.source)
        return None

    @property
    def angles(self) -> xr.Dataset:
        """The artifact `angles`."""
        return self.artifacts["angles"]

    @property
    def recordings(self) -> xr.Dataset:
        """The recordings in numbers."""
        return self.artifacts["summary"]["recordings"].to_dataset()

    @property
    def source(self) -> str:
        """`synthetic` or `measured`."""
        return str(self.angles.attrs["source"])

    @property
    def campaign(self) -> str:
        """The campaign's name, as its folder declares it."""
        return str(self.angles.attrs["campaign"])

    @property
    def load_unit(self) -> str:
        """Unit of the load, or `command`.

        It is `N m` for a finger, and the declared one for a specimen.
        """
        return label_load_unit(self.angles)

    @property
    def motion_unit(self) -> str:
        """Rad, or the declared unit of a specimen's motion."""
        return get_motion_unit(self.angles)

    @property
    def ci_prob(self) -> float:
        """Probability of the report's intervals."""
        return float(self.artifacts["summary"].attrs["ci_prob"])

    @property
    def is_alone(self) -> bool:
        """Whether there is one trial only.

        Nothing can be compared with it.
        """
        return self.angles.sizes["trial"] < 2

    @property
    def note(self) -> str:
        """What the fit leaves open, and what its noise includes."""
        return str(self.artifacts["summary"].attrs["note"])

    @property
    def is_fitted(self) -> bool:
        """Whether there is anything besides a diagnosis."""
        return "verdict" not in self or "posterior" in self

    @cached_property
    def bands(self) -> xr.Dataset:
        """The artifact `bands`, with named and sorted protocols.

        They are sorted by load if that distinguishes them.
        """
        bands, found = self.get("bands"), self.find("calibration")
        bands = bands.assign(protocol_trials=found["protocol_trials"])
        peaks = found["protocol_load"].values
        labels = [f"load {value:.3g} {self.load_unit}" for value in peaks]
        if len(set(labels)) < len(labels):
            return bands
        return bands.assign_coords(protocol=labels).isel(protocol=np.argsort(peaks))

    def cite(self, *names: str) -> str:
        """Name the rules and artifacts that numbers come from."""
        here = [name for name in names if name in self]
        return "; ".join(f"rule {self.stage_of(name)}, artifact {name}" for name in here)

    def stage_of(self, name: str) -> str:
        """Name the rule that made an artifact."""
        attrs = getattr(self.artifacts[name], "attrs", {})
        return str(attrs.get("stage", "unknown"))
