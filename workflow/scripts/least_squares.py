from softfinger.stages.least_squares import least_squares
from softfinger.stages.glue import run_stage

run_stage(least_squares, snakemake)
