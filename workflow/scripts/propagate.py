"""Rule `propagate`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.propagate import propagate

run_stage(propagate, snakemake)
