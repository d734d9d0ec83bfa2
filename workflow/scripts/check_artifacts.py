"""Rule `check_artifacts`."""

from softfinger.stages.check_artifacts import check_artifacts
from softfinger.stages.glue import run_stage

run_stage(check_artifacts, snakemake)
