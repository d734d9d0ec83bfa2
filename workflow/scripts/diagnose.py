"""Rule `diagnose`."""

from softfinger.stages.diagnose import diagnose
from softfinger.stages.glue import run_stage

run_stage(diagnose, snakemake)
