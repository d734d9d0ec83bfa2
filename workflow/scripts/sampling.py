"""Rule `sampling`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.sampling import sampling

run_stage(sampling, snakemake)
