"""Rule `track`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.track import track

run_stage(track, snakemake)
