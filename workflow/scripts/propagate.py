from softfinger.stages.propagate import propagate
from softfinger.stages.glue import run_stage

run_stage(propagate, snakemake)
