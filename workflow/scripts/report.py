"""Rule `report`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.report import report

run_stage(report, snakemake)
