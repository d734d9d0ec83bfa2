"""Rule `summarise`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.summarise import summarise

run_stage(summarise, snakemake)
