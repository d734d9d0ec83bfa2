"""Rule `virtual_rig`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.virtual_rig import virtual_rig

run_stage(virtual_rig, snakemake)
