"""Rule `fit`."""

from softfinger.stages.fit import fit
from softfinger.stages.glue import run_stage

run_stage(fit, snakemake)
