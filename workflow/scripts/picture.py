"""Rule `picture`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.picture import picture

run_stage(picture, snakemake)
