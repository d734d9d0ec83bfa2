"""What a report is written from: the artifacts, and what is read out of them once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.figures.style import label_load_unit
from softfinger.provenance import derive_seed
from softfinger.report.config import ReportConfig
from softfinger.report.paper import build_paper_table
from softfinger.report.prior import compute_prior_predictive
from softfinger.report.residuals import compute_residuals
from softfinger.report.summaries import (
    select_quantity,
    summarise_hyperparameters,
    summarise_trial_parameters,
)

Artifact = xr.Dataset | xr.DataTree | Mapping[str, Any]


@dataclass(frozen=True)
class Material:
    """The artifacts of one campaign; everything but `angles` may be missing."""

    artifacts: Mapping[str, Artifact]
    limits: ReportConfig
    config: Mapping[str, Any]
    commit: str | None = None

    def __post_init__(self) -> None:
        """Refuse a report about no recordings."""
        if "angles" not in self.artifacts:
            raise Fault("the report needs the artifact 'angles'; run the rule angles first")

    def __contains__(self, name: str) -> bool:
        """Say whether an artifact is there."""
        return self.artifacts.get(name) is not None

    def get(self, name: str) -> xr.Dataset:
        """Return an artifact, stamped with the campaign's source."""
        return self.artifacts[name].assign_attrs(source=self.source)

    @property
    def angles(self) -> xr.Dataset:
        """The artifact `angles`."""
        return self.artifacts["angles"]

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
        """`N m`, or `command`."""
        return label_load_unit(self.angles)

    @property
    def posterior(self) -> xr.Dataset | None:
        """The posterior draws."""
        return self.artifacts["posterior"]["posterior"].dataset if "posterior" in self else None

    @cached_property
    def bands(self) -> xr.Dataset:
        """The artifact `bands`, protocols named and sorted by load if that tells them apart."""
        bands = self.get("bands")
        load = self.angles["load_torque"].values
        peak = np.take_along_axis(load, np.abs(load).argmax(axis=1)[:, None], axis=1)[:, 0]
        of_trial = bands["protocol_of_trial"].values
        peaks = [np.median(peak[of_trial == name]) for name in bands["protocol"].values]
        labels = [f"load {value:.3g} {self.load_unit}" for value in peaks]
        if len(set(labels)) < len(labels):
            return bands
        return bands.assign_coords(protocol=labels).isel(protocol=np.argsort(peaks))

    @cached_property
    def residuals(self) -> xr.Dataset | None:
        """What the base model's fit leaves, at each trial's posterior mean parameters."""
        if self.posterior is None or "effect" in self.posterior:
            return None
        return compute_residuals(self.angles, summarise_trial_parameters(self.posterior))

    @cached_property
    def hyperparameters(self) -> xr.Dataset | None:
        """Intervals of the population's parameters, and what else is known of them."""
        if self.posterior is None:
            return None
        summary = summarise_hyperparameters(self.posterior, self.limits.ci_prob)
        return summary.assign(self._rivals(summary)).assign_attrs(source=self.source)

    def _rivals(self, summary: xr.Dataset) -> dict[str, xr.DataArray]:
        rivals = {}
        for name, artifact in (("two_stage", "least_squares"), ("truth", "truth")):
            if artifact in self and "population_mean" in self.artifacts[artifact]:
                found = self.artifacts[artifact]
                parts = [found["population_mean"], found["population_sd"]]
                rivals[name] = xr.concat(parts, summary["statistic"], join="exact")
        if self.is_like_the_paper:
            rivals["paper"] = build_paper_table()
        return {name: table.reindex_like(summary) for name, table in rivals.items()}

    @property
    def is_like_the_paper(self) -> bool:
        """Three joints under a torque: parameters have the paper's number and units."""
        return self.load_unit == "N m" and self.angles["joint"].size == 3

    @cached_property
    def prior_predictive(self) -> xr.Dataset | None:
        """What the priors expect, where the fit kept draws of them."""
        if "posterior" not in self or "prior" not in self.artifacts["posterior"].children:
            return None
        prior = self.artifacts["posterior"]["prior"].dataset
        rng = np.random.default_rng(derive_seed(int(self.config["seed"]), "report"))
        return compute_prior_predictive(prior, self.angles, rng)

    @cached_property
    def sampling(self) -> xr.Dataset | None:
        """Convergence of every hyperparameter, with the draws of the one that agrees least."""
        if self.posterior is None or "sampling" not in self:
            return None
        sampling = self.get("sampling")
        worst = str(sampling["quantity"].values[int(sampling["r_hat"].argmax("quantity"))])
        draws = select_quantity(self.posterior, worst)
        standard = (draws - draws.mean()) / draws.std()
        return sampling.assign(worst_draws=standard).assign_coords(worst_quantity=worst)

    @property
    def duration(self) -> float:
        """Length of the longest recording [s], its last frame's own interval included."""
        time = self.angles["time"].values
        return float(np.nanmax(time) + np.nanmedian(np.diff(time, axis=1)))

    @property
    def n_frames(self) -> int:
        """Frames of all trials."""
        return int(np.isfinite(self.angles["time"]).sum())

    def cite(self, *names: str) -> str:
        """Name the rules and artifacts that numbers come from."""
        here = [name for name in names if name in self]
        return "; ".join(f"rule {self.stage_of(name)}, artifact {name}" for name in here)

    def stage_of(self, name: str) -> str:
        """Name the rule that made an artifact."""
        attrs = getattr(self.artifacts[name], "attrs", {})
        return str(attrs.get("stage", "unknown"))
