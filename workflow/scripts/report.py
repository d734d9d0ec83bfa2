from softfinger.stages.report import report
from softfinger.stages.glue import run_stage

run_stage(report, snakemake)
