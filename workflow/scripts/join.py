"""Rule `join`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.join import join_recordings

run_stage(join_recordings, snakemake)
