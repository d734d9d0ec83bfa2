from softfinger.stages.virtual_rig import virtual_rig
from softfinger.stages.glue import run_stage

run_stage(virtual_rig, snakemake)
