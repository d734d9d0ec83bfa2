"""Rule `overlay`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.overlay import overlay

run_stage(overlay, snakemake)
