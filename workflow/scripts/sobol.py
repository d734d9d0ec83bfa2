"""Rule `sobol`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.sobol import sobol

run_stage(sobol, snakemake)
