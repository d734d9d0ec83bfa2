"""Rule `conceal`."""

from softfinger.stages.glue import run_stage
from softfinger.stages.conceal import conceal

run_stage(conceal, snakemake)
