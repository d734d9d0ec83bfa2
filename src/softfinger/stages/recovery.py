"""Rule `recovery`: how both fits recover the truth."""

from pathlib import Path

from softfinger.artifacts import open_artifact, open_tree, save_artifact
from softfinger.artifacts.specs import least_squares as least_squares_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import recovery as recovery_spec
from softfinger.artifacts.specs import truth as truth_spec
from softfinger.estimation.recovery import measure_recovery, tabulate_recovery
from softfinger.provenance import describe_run


def recovery(
    *, truth: Path, least_squares: Path, posterior: Path, recovery: Path, table: Path
) -> None:
    """Write errors and coverage, also as CSV."""
    roles = {"truth": truth, "least_squares": least_squares, "posterior": posterior}
    measured = measure_recovery(
        open_artifact(truth, truth_spec.SPEC),
        open_artifact(least_squares, least_squares_spec.SPEC),
        open_tree(posterior, posterior_spec.SPEC)["posterior"].to_dataset(),
    )
    provenance = describe_run("recovery", roles, {})
    save_artifact(measured, recovery_spec.SPEC, recovery, provenance)
    tabulate_recovery(measured).to_csv(table, index=False, float_format="%.4g")
