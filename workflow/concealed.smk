# The proof: conceal physics in campaigns, seal what was concealed, diagnose blind, open, score.
import hashlib
import random
import sys
from pathlib import Path

from snakemake.utils import min_version, validate

from softfinger.config import read_config
from softfinger.provenance import code_hash, environment_hash
from softfinger.stages.keys import choose_settings

min_version("9.0")


configfile: Path(workflow.basedir).parent / "config/concealed.yaml"


validate(config, "schemas/concealed.schema.yaml")

OUT = Path(config["out"]) / f"seed_{config['seed']}"
ENVIRONMENT = environment_hash()
DEFAULTS = read_config()  # which the command line reads by itself
DIAGNOSED = {k: DEFAULTS[k] for k in ("tracking", "mismatch", "seed", "trials_per_job")}
COMMAND_LINE = (  # what `diagnose --no-report` runs, and not the report
    "softfinger.cli.application",
    "softfinger.stages.prepare",
    "softfinger.stages.diagnose",
)
DRAWN = (
    "kind",
    "campaigns",
    "filmed",
    "longest",
    "clean",
    "twins",
    "foreign",
    "catalogue",
)
SUITE = {key: config[key] for key in DRAWN}
COUNT = (  # the paper's own case, twice; a twin has a sibling
    config["campaigns"] + 2 + config["clean"] + 2 * config["twins"] + config["foreign"]
)
# Names that tell nothing, of neither the seed nor the place in the suite.
CASES = {
    hashlib.sha256(f"{config['seed']}/{k}".encode()).hexdigest()[:10]: k
    for k in range(COUNT)
}
SHUFFLED = random.Random(config["seed"]).sample(list(CASES), len(CASES))
SAMPLED, COMPARED, LIMITED = (
    SHUFFLED[: config[key]] for key in ("sampled", "rivals", "limits")
)
REAL = Path(config["measured"]["folder"])
KNOWN = {
    n: known for n, known in config["measured"]["known"].items() if (REAL / n).is_dir()
}
TEXTS = ("salt", "seal", "digest")


def find_place(wildcards):
    return CASES[wildcards.case]


def is_sampled(wildcards):
    return wildcards.case in SAMPLED


wildcard_constraints:
    case="[0-9a-f]{10}",


localrules:
    all,


rule all:
    default_target: True
    input:
        OUT / "score.html",


include: "rules/concealed.smk"
