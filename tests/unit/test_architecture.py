"""Data flows forward: which part may import which."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import softfinger
from softfinger.config import read_config
from softfinger.provenance import find_modules
from softfinger.stages.keys import KEYS

PACKAGE = Path(softfinger.__file__).parent
EVERYWHERE = {"compiled", "faults", "gate", "progress", "settings", "units"}
GROUND = EVERYWHERE | {
    "campaign",
    "artifacts",
    "provenance",
    "mechanics",
    "measurement",
    "inference",
    "doubts",
}
STAGES = ("tracking", "estimation", "propagation", "mismatch", "virtual_rig", "summary")
ALLOWED = {
    "compiled": set(),
    "faults": set(),
    "units": set(),
    "gate": {"faults"},
    "processes": set(),
    "progress": set(),
    "failure": {"faults"},
    "guard": set(),
    "doctor": EVERYWHERE | {"provenance"},
    "reproduction": EVERYWHERE | {"provenance"},
    "settings": {"faults"},
    "provenance": EVERYWHERE,
    "doubts": {"faults"},
    "campaign": EVERYWHERE,
    "artifacts": EVERYWHERE | {"provenance", "processes"},
    "config": EVERYWHERE | {"provenance"},
    "mechanics": EVERYWHERE,
    "measurement": EVERYWHERE | {"mechanics"},
    "inference": EVERYWHERE | {"mechanics", "measurement", "campaign"},
    "concealed": EVERYWHERE | {"campaign"},
    "importing": EVERYWHERE | {"campaign"},
    **dict.fromkeys(STAGES, GROUND),
}
ALLOWED["rig"] = EVERYWHERE | {"campaign", "mechanics", "virtual_rig"}
ALLOWED["schema"] = EVERYWHERE | set(STAGES)
ALLOWED["figures"] = {"units"}
ALLOWED["report"] = {"faults", "figures", "units"}
COMPUTING = {"arviz", "numba", "pymc", "scipy", "sklearn", "statistics", "statsmodels"}
"""Libraries that compute."""
STATISTICS = {
    *("bincount", "corr", "cov", "cumsum", "digitize", "fft", "groupby", "histogram", "interp"),
    *("linalg", "mean", "median", "nanmean", "nanmedian", "nanquantile", "nanstd", "percentile"),
    *("polyfit", "quantile", "random", "std", "trapezoid", "var"),
}
"""Names of numpy and xarray that do."""


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
    return sorted(found - {"__init__", "stages", "cli", "api"})  # which may import all


@pytest.mark.parametrize("part", list_parts())
def test_a_part_imports_only_what_lies_below_it(part):
    assert part in ALLOWED, f"say in this test what {part} may import"
    assert imported_parts(part) <= ALLOWED[part]


def test_nothing_but_the_command_line_imports_the_stages():
    for part in list_parts():
        assert not imported_parts(part) & {"stages", "cli", "api"}


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


def test_an_effect_is_known_to_no_kernel_and_to_no_other_effect():
    """Only so an edit of one compiles nothing else, and one more touches its file and its line.

    `forward/slots.py` and `forward/simulate.py` ask the catalogue for whatever effects there are.
    """
    mechanics = PACKAGE / "mechanics"
    catalogue = ast.parse((mechanics / "effects/__init__.py").read_text())
    (modules,) = (
        {element.id for element in node.value.elts}
        for node in catalogue.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "MODULES"
    )
    files = [mechanics / "effects" / f"{module}.py" for module in sorted(modules)]
    for file in (*files, *(mechanics / "forward").glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                taken = {(node.module or "").split(".")[-1], *(alias.name for alias in node.names)}
                assert not taken & modules, f"{file} imports {taken & modules}"


@pytest.mark.parametrize("part", ["figures", "report"])
def test_what_renders_computes_nothing(part):
    for file in (PACKAGE / part).rglob("*.py"):
        tree = ast.parse(file.read_text())
        imported = {
            alias.name for n in ast.walk(tree) if isinstance(n, ast.Import) for alias in n.names
        }
        imported |= {n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
        assert not {name.split(".")[0] for name in imported} & COMPUTING, file
        used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        assert not used & STATISTICS, f"{file}: let a stage compute this"


def test_scripts_import_stages_and_nothing_else():
    for script in (PACKAGE.parents[1] / "workflow/scripts").glob("*.py"):
        modules = {n.module for n in ast.parse(script.read_text()).body if hasattr(n, "module")}
        assert modules == {"softfinger.stages.glue", f"softfinger.stages.{script.stem}"}


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        ("softfinger.cli", ("pymc", "cv2", "numba")),
        ("softfinger.stages.diagnose", ("pymc", "arviz", "matplotlib", "cv2")),
        ("softfinger.stages.prepare", ("pymc", "arviz", "matplotlib")),
    ],
)
def test_help_and_a_diagnosis_without_sampling_load_no_heavy_library(module, heavy):
    code = f"import sys, {module}; print([m for m in {heavy} if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_no_compiled_code_has_leave_to_reorder_sums():
    """What a compiler makes of that leave depends on what else it compiles: bits would differ."""
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.keyword) and node.arg and "fastmath" in node.arg:
                assert ast.unparse(node.value) == "False", f"{file}:{node.value.lineno}"


def test_every_compiled_function_is_compiled_by_the_projects_own_decorator():
    """Numba's own cache may return what an edited callee returned before."""
    known = {"decorator.py", "doctor.py", "sampling.py"}  # itself, a trial, what PyTensor generates
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "numba":
                names = {alias.name for alias in node.names}
                assert not names & {"njit", "jit"} or file.name in known, f"{file}: {names}"


def measure_body(function: ast.FunctionDef) -> int:
    """Lines of a function below its signature and docstring."""
    first = function.body[1 if ast.get_docstring(function) and function.body[1:] else 0]
    return function.end_lineno - first.lineno + 1


def test_modules_and_bodies_are_short():
    """At most 300 and 40 lines: what is longer does two things."""
    lengths = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        source, name = file.read_text(), file.relative_to(PACKAGE).as_posix()
        lengths[name] = len(source.splitlines()) / 300
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.FunctionDef):
                lengths[f"{name}: {node.name}"] = measure_body(node) / 40
    assert [place for place, share in lengths.items() if share > 1] == []


def list_words(stage: str) -> set[str]:
    """Attributes and texts in the code that a stage uses, but where keys are only declared."""
    words = set()
    for path in find_modules(f"softfinger.stages.{stage}").values():
        if path.suffix == ".py" and path.name not in {"config.py", "keys.py", "example.py"}:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Attribute):
                    words.add(node.attr)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    words.add(node.value)
    return words


@pytest.mark.parametrize("stage", [stage for stage, (_, keys) in KEYS.items() if keys])
def test_a_stage_is_given_the_keys_that_its_code_reads(stage):
    block, keys = KEYS[stage]
    words = list_words(stage)
    unused = set(keys) - words
    assert not unused, f"{stage} does not read {unused}: take them from stages/keys.py"
    others = set(read_config()[block]) - set(keys) - {"cores", "fps", "level"}  # common words
    others -= {"band_samples", "running_times_s"}  # in modules that other stages use in part
    missing = others & words
    assert not missing, f"{stage} reads {missing}: add them in stages/keys.py"


def test_every_rule_runs_again_with_its_code_its_settings_and_its_libraries():
    for file in (PACKAGE.parents[1] / "workflow/rules").glob("*.smk"):
        for rule in re.split(r"^ *rule\b", file.read_text(encoding="utf-8"), flags=re.M)[1:]:
            if "script:" in rule and "check_artifacts" not in rule:
                assert "code=code_hash(" in rule, f"{file}: {rule}"
                assert "environment=ENVIRONMENT" in rule, f"{file}: {rule}"
            assert "config=config[" not in rule, f"{file}: choose_settings(config, stage)"


ROUNDING = {
    *("NEGLIGIBLE", "ROUNDING", "LEAST_SD", "UNKNOWN", "TOLERANCE", "RIDGE", "ENDLESS", "RESTS"),
    *("SLIGHT", "LEAST_INFORMATION", "LARGEST_LOG", "FAR", "ROUNDS", "FARTHEST"),
    *("LEAST_SHARE", "CLEAR", "LOG_TWO_PI", "WIDEST"),
}
"""Numerics beside their equation: guards, asymptotic limits, constants of mathematics."""
DIFFERENCES = {"APART", "STEP_SHARE", "STEP_S"}
"""Steps of numerical derivatives."""
LAYOUT = {"OWN", "TURN", "MISSING", "STALE", "JUMP"}
"""Shapes, changes of coordinates, and bits of a file's flags."""


def list_numbers(tree: ast.Module) -> list[str]:
    """Names of capitals that a module gives a number, in any expression but within a function."""
    found = []
    for node in tree.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        inside = [n for part in ast.walk(node.value) if isinstance(part, ast.Lambda)
                  for n in ast.walk(part)]  # fmt: skip
        numbers = [
            n for n in ast.walk(node.value)
            if isinstance(n, ast.Constant) and type(n.value) in (int, float) and n not in inside
        ]  # fmt: skip
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
        found += [name for name in names if numbers and name.isupper()]
    return found


@pytest.mark.parametrize("part", ["inference", "measurement", "mismatch"])
def test_numbers_that_decide_are_gathered(part):
    """In decisions.py, budget.py or priors.py of the part, each with its reason."""
    gathered = {"decisions.py", "budget.py", "priors.py"}
    for file in (PACKAGE / part).rglob("*.py"):
        if file.name not in gathered or file.parent.name != part:
            loose = set(list_numbers(ast.parse(file.read_text())))
            assert loose <= ROUNDING | DIFFERENCES | LAYOUT, f"{file}: {loose}"


def list_definitions(kind: type) -> dict[str, list[Path]]:
    """Public names that modules define, but for `concealed`, which shares no word on purpose."""
    found: dict[str, list[Path]] = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        place = file.relative_to(PACKAGE)
        if place.parts[0] != "concealed":
            for node in ast.parse(file.read_text()).body:
                if isinstance(node, kind):
                    found.setdefault(node.name, []).append(place)
    return found


def test_no_two_classes_have_one_name():
    twins = {name: places for name, places in list_definitions(ast.ClassDef).items()
             if len(places) > 1}  # fmt: skip
    assert twins == {}


def test_functions_of_one_name_in_different_parts_mean_one_thing():
    """A verb has one name as command, stage and library call; a block of settings is read alike."""
    alike = {"read_config", "main"}
    for name, places in list_definitions(ast.FunctionDef).items():
        parts = {place.parts[0] for place in places}
        verb = parts & {"cli", "stages"}
        if not name.startswith("_") and name not in alike and not verb:
            assert len(parts) == 1, f"{name}: {places}"
