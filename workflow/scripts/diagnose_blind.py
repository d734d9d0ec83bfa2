"""Rule `diagnose_blind`."""

from softfinger.stages.diagnose_blind import diagnose_blind
from softfinger.stages.glue import run_stage

run_stage(diagnose_blind, snakemake)
