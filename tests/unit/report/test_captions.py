"""The captions of `snakemake --report` state the limits that the report really uses."""

from pathlib import Path
from types import SimpleNamespace

import jinja2
import pytest
from example_artifacts import CONFIG

FOLDER = Path(__file__).parents[3] / "workflow/report"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.rst")), ids=lambda path: path.name)
def test_captions_render_with_the_configuration(path):
    job = SimpleNamespace(config=CONFIG, wildcards=SimpleNamespace(name="sobol"))
    template = jinja2.Template(path.read_text(), undefined=jinja2.StrictUndefined)
    assert "{{" not in template.render(snakemake=job)


def test_the_reports_caption_states_every_limit():
    estimation = {**CONFIG["estimation"], "r_hat_max": 1.0345}
    job = SimpleNamespace(config={**CONFIG, "estimation": estimation})
    caption = jinja2.Template((FOLDER / "report.rst").read_text()).render(snakemake=job)
    for limit in ("1.0345", "400.0", "0.7", "90 %", "5 percentage", "2.0 times"):
        assert limit in " ".join(caption.split())
