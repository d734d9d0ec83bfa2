"""Rule `doubt`."""

from softfinger.stages.doubt import doubt
from softfinger.stages.glue import run_stage

run_stage(doubt, snakemake)
