"""What Snakemake's catalogue of workflows asks for."""

import re
import subprocess
import sys

from softfinger.gate import read_document
from softfinger.provenance import PROJECT

WORKFLOW = PROJECT / "workflow"


def test_the_workflow_is_where_the_catalogue_looks():
    assert (WORKFLOW / "Snakefile").is_file()
    usage = read_document(PROJECT / ".snakemake-workflow-catalog.yml").content["usage"]
    assert set(usage) == {"mandatory-flags", "software-stack-deployment", "report"}
    readme = (PROJECT / "README.md").read_text(encoding="utf-8").lower()
    assert "snakemake" in readme
    assert "workflow" in readme


def test_the_readme_of_the_configuration_names_every_file():
    text = (PROJECT / "config/README.md").read_text(encoding="utf-8")
    assert "--software-deployment-method" in text
    for file in (PROJECT / "config").glob("*.yaml"):
        assert f"`{file.name}`" in text or file.name.startswith("concealed"), file.name


def test_every_file_of_the_report_has_a_caption():
    reports = [
        body
        for rules in (WORKFLOW / "rules").glob("*.smk")
        for body in re.findall(r"\breport\(\n(.*?)\n {8,12}\)", rules.read_text("utf-8"), re.DOTALL)
    ]
    captions = [re.search(r'caption="\.\./report/(\w+\.rst)"', body) for body in reports]
    assert len(captions) >= 3
    assert all(caption and (WORKFLOW / "report" / caption[1]).is_file() for caption in captions)


def test_the_linter_of_snakemake_finds_nothing():
    command = [sys.executable, "-m", "snakemake", "--lint"]
    done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True)
    found = set(re.findall(r"^ +\* (.*?):?$", done.stderr, re.MULTILINE))
    assert (found, done.returncode) == (set(), 0)


def test_the_image_of_the_rules_has_a_recipe():
    image = re.search(
        r'^container: "(\w+)\.sif"', (WORKFLOW / "Snakefile").read_text(), re.MULTILINE
    )
    assert (WORKFLOW / f"container/{image[1]}.def").is_file()
