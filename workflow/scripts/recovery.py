"""Rule `recovery`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.recovery import recovery

run_stage(recovery, snakemake)
