"""Rule `tracking_quality`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.tracking_quality import tracking_quality

run_stage(tracking_quality, snakemake)
