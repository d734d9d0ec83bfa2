"""Data flows forward: which part may import which."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import softfinger

PACKAGE = Path(softfinger.__file__).parent
EVERYWHERE = {"faults", "progress", "settings"}
GROUND = EVERYWHERE | {"campaign", "artifacts", "provenance", "mechanics", "population"}
STAGES = ("tracking", "estimation", "propagation", "mismatch", "virtual_rig", "figures", "report")
ALLOWED = {
    "faults": set(),
    "progress": set(),
    "doctor": EVERYWHERE | {"provenance"},
    "reproduction": EVERYWHERE | {"provenance"},
    "settings": {"faults"},
    "provenance": EVERYWHERE,
    "campaign": EVERYWHERE,
    "artifacts": EVERYWHERE | {"provenance"},
    "config": EVERYWHERE | {"provenance"},
    "mechanics": EVERYWHERE,
    "population": EVERYWHERE | {"mechanics"},
    "concealed": EVERYWHERE | {"campaign"},
    **dict.fromkeys(STAGES, GROUND),
}
ALLOWED["rig"] = EVERYWHERE | {"campaign", "mechanics", "virtual_rig"}
ALLOWED["schema"] = EVERYWHERE | set(STAGES)
ALLOWED["report"] = GROUND | {"figures"}


def imported_parts(part: str) -> set[str]:
    base = PACKAGE / part
    files = base.rglob("*.py") if base.is_dir() else [base.with_suffix(".py")]
    parts = set()
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{file} imports relatively"
                names = [node.module or ""]
                if node.module == "softfinger":
                    names = [f"softfinger.{alias.name}" for alias in node.names]
            parts |= {n.split(".")[1] for n in names if n.startswith("softfinger.")}
    return parts - {part}


def list_parts() -> list[str]:
    found = {
        p.stem for p in PACKAGE.iterdir() if p.suffix == ".py" or (p / "__init__.py").is_file()
    }
    return sorted(found - {"__init__", "stages", "cli"})


@pytest.mark.parametrize("part", list_parts())
def test_a_part_imports_only_what_lies_below_it(part):
    assert part in ALLOWED, f"say in this test what {part} may import"
    assert imported_parts(part) <= ALLOWED[part]


def test_nothing_but_the_command_line_imports_the_stages():
    for part in list_parts():
        assert not imported_parts(part) & {"stages", "cli"}


def test_no_two_parts_import_each_other():
    graph = {part: imported_parts(part) for part in list_parts()}

    def reach(part: str) -> set[str]:
        seen, waiting = set(), list(graph[part])
        while waiting:
            node = waiting.pop()
            if node not in seen:
                seen.add(node)
                waiting += graph.get(node, ())
        return seen

    assert [part for part in graph if part in reach(part)] == []


def test_scripts_import_stages_and_nothing_else():
    for script in (PACKAGE.parents[1] / "workflow/scripts").glob("*.py"):
        modules = {n.module for n in ast.parse(script.read_text()).body if hasattr(n, "module")}
        assert modules == {"softfinger.stages.glue", f"softfinger.stages.{script.stem}"}


def test_help_does_not_load_the_heavy_libraries():
    code = (
        "import sys, softfinger.cli; print([m for m in ('pymc','cv2','numba') if m in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_no_compiled_code_has_leave_to_reorder_sums():
    """What a compiler makes of that leave depends on what else it compiles: bits would differ."""
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.keyword) and node.arg and "fastmath" in node.arg:
                assert ast.unparse(node.value) == "False", f"{file}:{node.value.lineno}"
