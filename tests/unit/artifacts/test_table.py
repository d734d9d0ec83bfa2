from pathlib import Path

from softfinger.artifacts.table import format_table, renew_table

README = Path(__file__).parents[3] / "README.md"


def test_the_readme_shows_the_present_artifacts():
    text = README.read_text(encoding="utf-8")
    assert format_table() in text, "run: python -m softfinger.artifacts.table README.md"
    assert renew_table(text) == text
