"""Rule `conceal`."""

from softfinger.stages.conceal import conceal
from softfinger.stages.glue import run_stage

run_stage(conceal, snakemake)
