"""Rule `score`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.score import score

run_stage(score, snakemake)
