"""The report of a specimen speaks in its units, and nowhere of radians."""

import re

import xarray as xr
from example_artifacts import gather, make_artifacts, sum_up

from softfinger.artifacts.declared_units import state_in_declared_units
from softfinger.report.page import render_report
from softfinger.stages.opening import SPECS, SUMMED


def stamp(artifacts):
    """Units of the declarations, as files have them."""
    for name, spec in (SPECS | SUMMED).items():
        artifact = artifacts.get(name)
        parts = [(artifact, spec.variables)]
        if isinstance(artifact, xr.DataTree):
            parts = [(artifact[g].dataset, v) for g, v in spec.groups.items() if g in artifact]
        for part, variables in parts if artifact is not None else ():
            for variable in set(variables) & set(part.variables):
                part[variable].attrs["units"] = variables[variable].units
    return artifacts


def test_figures_and_tables_speak_in_the_declared_units():
    artifacts = sum_up(make_artifacts())
    artifacts["angles"] = artifacts["angles"].assign_attrs(
        motion_quantity="displacement", motion_unit="mm", motion_per_rad=20.0,
        load_quantity="force", load_unit="N",
    )  # fmt: skip
    page = render_report(gather(state_in_declared_units(stamp(artifacts))))
    words = re.sub(r"<style.*?</style>|<script.*?</script>|data:[^\"']*", "", page, flags=re.S)
    assert "N/mm" in words
    assert "10⁻³ mm" in words
    assert "mrad" not in words
    assert "without a physical unit" not in words  # its load is in N
    assert "a load in N," in words
    assert re.findall(r".{40}\brad\b.{20}", words) == []
