from softfinger.stages.track import track
from softfinger.stages.glue import run_stage

run_stage(track, snakemake)
