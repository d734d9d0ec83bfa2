"""Rule `least_squares`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.least_squares import least_squares

run_stage(least_squares, snakemake)
