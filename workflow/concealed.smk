# The proof: conceal physics in campaigns, seal what was concealed, diagnose blind, open, score.
import hashlib
import random
import sys
from pathlib import Path

from snakemake.utils import min_version, validate

from softfinger.provenance import code_hash

min_version("9.0")


configfile: Path(workflow.basedir).parent / "config/concealed.yaml"


validate(config, "schemas/concealed.schema.yaml")

OUT = Path(config["out"]) / f"seed_{config['seed']}"
SUITE = {key: config[key] for key in ("kind", "campaigns", "filmed", "longest")}
# Names that tell nothing, of neither the seed nor the place in the suite.
CASES = {
    hashlib.sha256(f"{config['seed']}/{k}".encode()).hexdigest()[:10]: k
    for k in range(config["campaigns"] + 2)  # the paper's own case, twice, comes last
}
SAMPLED = random.Random(config["seed"]).sample(list(CASES), config["sampled"])
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
