"""The proof must not share code with what it puts to the test."""

import ast
import subprocess
import sys
from pathlib import Path

import softfinger.concealed

ALLOWED = {"concealed", "campaign", "compiled", "faults", "gate", "progress"}
FOLDER = Path(softfinger.concealed.__file__).parent


def test_source_names_only_what_is_allowed():
    found = set()
    for path in FOLDER.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{path.name} imports relatively"
                names = [f"{node.module}.{alias.name}" for alias in node.names]
            elif isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                continue
            found |= {name.split(".")[1] for name in names if name.split(".")[0] == "softfinger"}
    assert "concealed" in found
    assert found <= ALLOWED


def test_nothing_else_is_loaded_at_run_time():
    code = (
        "import sys, softfinger.concealed, softfinger.concealed.score\n"
        "print(*{m.split('.')[1] for m in sys.modules if m.startswith('softfinger.')})"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120
    )
    assert set(run.stdout.split()) <= ALLOWED
