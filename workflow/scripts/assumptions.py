"""Rule `assumptions`."""

from softfinger.stages.assumptions import assumptions
from softfinger.stages.glue import run_stage

run_stage(assumptions, snakemake)
