from pathlib import Path

from snakemake.utils import min_version, validate

min_version("9.0")


configfile: Path(workflow.basedir) / "config/default.yaml"


validate(config, "workflow/schemas/config.schema.yaml")


include: "workflow/rules/common.smk"
include: "workflow/rules/virtual_rig.smk"
include: "workflow/rules/track.smk"
include: "workflow/rules/angles.smk"
include: "workflow/rules/doubt.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/propagate.smk"
include: "workflow/rules/sobol.smk"
include: "workflow/rules/assumptions.smk"
include: "workflow/rules/diagnose.smk"
include: "workflow/rules/summarise.smk"
include: "workflow/rules/report.smk"


localrules:
    all,


rule all:
    default_target: True
    input:
        report=OUT / "report.html",
        receipt=OUT / "receipt.csv",
