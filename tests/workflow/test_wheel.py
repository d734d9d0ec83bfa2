"""The built wheel alone: what it contains, and that it runs without the repository."""

import shutil
import subprocess
import sys
import sysconfig
import zipfile
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import pytest

from softfinger.provenance import code_hash

PROJECT = Path(__file__).parents[2]
LARGEST_BYTES = 5_000_000
SHIPPED = ("workflow", "config", "profiles", "data/example", "environment.lock")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=PROJECT, check=True, capture_output=True)
    (built,) = folder.glob("*.whl")
    return built


@dataclass(frozen=True)
class Installation:
    """A virtual environment with the wheel, and an empty home."""

    root: Path

    @property
    def bin(self):
        return self.root / "venv/bin"

    def run(self, *command, **more):
        """Run a command in the empty home, with nothing of this project in the environment."""
        home = self.root / "home"
        home.mkdir(exist_ok=True)
        bare = {"PATH": f"{self.bin}:/usr/bin:/bin", "HOME": str(home), "LANG": "C.UTF-8"}
        return subprocess.run(
            command, cwd=home, env=bare | more, capture_output=True, text=True, check=False
        )

    def softfinger(self, *arguments):
        return self.run("softfinger", *map(str, arguments))


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """The wheel in an environment of its own, which borrows only the locked libraries.

    Nothing is fetched: their folder is on its path. Their links to this checkout do not work
    there, for files that end in .pth count only in an environment's own folder.
    """
    there = Installation(tmp_path_factory.mktemp("installed"))
    subprocess.run([sys.executable, "-m", "venv", there.root / "venv"], check=True)
    pip = [there.bin / "python", "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    subprocess.run([*pip, wheel], check=True)
    (packages,) = (there.root / "venv/lib").glob("python*/site-packages")
    (packages / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n")
    for code in (PROJECT / "src").rglob("__pycache__/*.nbc"):  # what is compiled is compiled once
        target = packages / code.relative_to(PROJECT / "src")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(code, target)
    return there


def test_the_wheel_is_small_and_has_one_version(wheel):
    assert wheel.stat().st_size < LARGEST_BYTES
    assert wheel.name == f"softfinger-{version('softfinger')}-py3-none-any.whl"
    citation = (PROJECT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {version('softfinger')}\n" in citation


def test_the_wheel_contains_what_the_package_needs_and_no_more(wheel):
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *SHIPPED]
    wanted = subprocess.run(listed, cwd=PROJECT, check=True, capture_output=True, text=True)
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        for file in wanted.stdout.splitlines():
            content = archive.read(f"softfinger/project/{file}")
            assert content == (PROJECT / file).read_bytes(), file
    inside = {f"softfinger/project/{file}" for file in wanted.stdout.splitlines()}
    others = {name for name in names if name.startswith("softfinger/project/")} - inside
    assert others == set()
    assert [name for name in names if "__pycache__" in name or "tests/" in name] == []
    assert {name.split("/")[0].split("-")[0] for name in names} == {"softfinger"}


def test_the_installed_package_is_not_the_checkout(installed):
    code = "import softfinger, softfinger.provenance as p; print(softfinger.__file__, p.PROJECT)"
    said = installed.run("python", "-c", code).stdout.split()
    assert all(Path(path).is_relative_to(installed.root / "venv") for path in said)
    assert len(said) == 2


def test_code_has_one_hash_wherever_it_is_installed(installed):
    code = "from softfinger.provenance import code_hash as h; print(h('fit'), h('report'))"
    said = installed.run("python", "-c", code).stdout.split()
    assert said == [code_hash("fit"), code_hash("report")]


def test_light_commands_run_in_an_empty_home(installed):
    assert installed.softfinger("--version").stdout == f"softfinger {version('softfinger')}\n"
    assert "wire_friction" in installed.softfinger("effects").stdout
    assert installed.softfinger("new", "mine").returncode == 0
    refused = installed.softfinger("check", "mine")
    assert refused.returncode == 1
    assert "finger.joints: is still empty" in refused.stderr


def test_the_installed_workflow_plans_a_run(installed):
    project = next((installed.root / "venv/lib").glob("python*/site-packages/softfinger/project"))
    done = installed.run(
        *(
            "python",
            "-m",
            "snakemake",
            "--snakefile",
            str(project / "workflow/Snakefile"),
            "--dry-run",
        ),
        *("--cores", "1", "--config", f"campaign={project / 'data/example'}", "out=out"),
    )
    assert done.returncode == 0, done.stderr
    assert "Write the report" in done.stdout


@pytest.mark.slow
def test_demo_and_run_end_in_a_report_in_an_empty_home(installed):
    done = installed.softfinger("demo")
    home = installed.root / "home"
    assert done.returncode == 0, done.stderr
    assert f"the report is {home / 'softfinger-demo/report.html'}" in done.stdout
    assert "adequate" in done.stdout
    assert "Soft finger report" in (home / "softfinger-demo/report.html").read_text("utf-8")
    ran = installed.softfinger("run", "softfinger-demo/campaign", "--out", "results", "--cores", 1)
    assert ran.returncode == 0, ran.stderr
    assert (home / "results/report.html").is_file()
    assert str(PROJECT) not in (home / "results/report.html").read_text("utf-8")
