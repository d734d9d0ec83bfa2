"""The README's table of artifacts, from their declarations.

``python -m softfinger.artifacts.table README.md`` renews it; a test finds drift.
"""

import re
import sys
from pathlib import Path

from softfinger.artifacts.spec import ArtifactSpec, Variable
from softfinger.artifacts.specs import list_specs

BEGIN, END = "<!-- artifacts: begin -->", "<!-- artifacts: end -->"
PLACE = re.compile(f"{re.escape(BEGIN)}.*?{re.escape(END)}", re.DOTALL)


def format_table() -> str:
    """Markdown table: artifact, rule, variables with units."""
    rows = [f"| `{s.name}.nc` | `{s.rule}` | {_list_variables(s)} |" for s in list_specs()]
    return "\n".join(["| artifact | rule | variables [unit] |", "| --- | --- | --- |", *rows])


def renew_table(text: str) -> str:
    """Text with an up-to-date table between its marks."""
    return PLACE.sub(f"{BEGIN}\n{format_table()}\n{END}", text)


def _list_variables(spec: ArtifactSpec) -> str:
    def name(key: str, variable: Variable) -> str:
        unit = "" if variable.units == "1" else f" [{variable.units}]"
        return f"{key}{unit}"

    groups = [f"{group}/" for group in spec.groups]
    return ", ".join([name(k, v) for k, v in spec.variables.items()] + groups)


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(renew_table(file.read_text(encoding="utf-8")), encoding="utf-8")
