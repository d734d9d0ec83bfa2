"""Rule `shapley`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.shapley import shapley

run_stage(shapley, snakemake)
