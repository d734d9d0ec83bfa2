from softfinger.stages.sobol import sobol
from softfinger.stages.glue import run_stage

run_stage(sobol, snakemake)
