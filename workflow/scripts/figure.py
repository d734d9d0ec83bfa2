"""Rule `figure`."""

from softfinger.stages.figure import figure
from softfinger.stages.glue import run_stage

run_stage(figure, snakemake)
