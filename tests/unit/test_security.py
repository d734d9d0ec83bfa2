"""Nothing that is read can run code, and nothing is fetched."""

import ast
from pathlib import Path

import pytest

import softfinger

PACKAGE = Path(softfinger.__file__).parent
PROJECT = PACKAGE.parents[1]
FILES = sorted(
    path
    for folder in ("src", "workflow", "docs", "benchmarks")
    for path in (PROJECT / folder).rglob("*.py")
)
MODULES = {
    "pickle", "cPickle", "dill", "cloudpickle", "joblib", "shelve", "marshal",  # run what they read
    "yaml",  # PyYAML: its plain load runs what it reads; ruamel.yaml stands in for it
    "socket", "ssl", "http", "urllib", "urllib3", "requests", "httpx", "ftplib", "smtplib",
}  # fmt: skip
CALLS = {"eval", "exec", "__import__", "os.system", "os.popen", "read_pickle", "to_pickle"}
WORDS = {("allow_pickle", True), ("shell", True), ("typ", "unsafe")}
KNOWN = {
    "virtual_camera.py": ["socket"],  # to the simulator on 127.0.0.1
    "cache.py": ["pickle"],  # machine code, which runs anyway, in the form that numba gives it
}


def list_dangers(code: str) -> list[str]:
    """Imports, calls and arguments that could run what was read, or reach the network."""
    found = []
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Import):
            found += [a.name for a in node.names if a.name.partition(".")[0] in MODULES]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in MODULES:
            found.append(str(node.module))
        elif isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            found += [name] if {name, name.rpartition(".")[2]} & CALLS else []
            words = {(k.arg, getattr(k.value, "value", None)) for k in node.keywords}
            found += [f"{key}={value}" for key, value in words & WORDS]
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PROJECT)))
def test_no_code_runs_what_it_reads_or_reaches_the_network(path):
    assert list_dangers(path.read_text(encoding="utf-8")) == KNOWN.get(path.name, [])


@pytest.mark.parametrize(
    "code",
    [
        "import pickle",
        "from yaml import load",
        "import urllib.request",
        "eval(text)",
        "os.system(text)",
        "np.load(path, allow_pickle=True)",
        "subprocess.run(text, shell=True)",
        "YAML(typ='unsafe')",
    ],
)
def test_each_danger_would_be_seen(code):
    assert len(list_dangers(code)) == 1
