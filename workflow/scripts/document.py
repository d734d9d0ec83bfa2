"""Rule `document`."""

from softfinger.stages.document import document
from softfinger.stages.glue import run_stage

run_stage(document, snakemake)
