"""Rule `angles`."""

from softfinger.stages.angles import angles
from softfinger.stages.glue import run_stage

run_stage(angles, snakemake)
