"""Rule `limit`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.limit import limit

run_stage(limit, snakemake)
