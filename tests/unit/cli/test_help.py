"""Every verb has a help with an example that the command line takes, and completes."""

import json
import os
import shlex
import subprocess
import sys
from importlib.metadata import version

import pytest
import typer.main
from typer.testing import CliRunner

from softfinger import cli
from softfinger.cli import app
from softfinger.provenance import find_modules

GROUP = typer.main.get_command(app)


def list_verbs():
    for name, command in GROUP.commands.items():
        for verb, part in getattr(command, "commands", {}).items():
            yield pytest.param([name, verb], part, id=f"{name} {verb}")
        if not hasattr(command, "commands"):
            yield pytest.param([name], command, id=name)


@pytest.mark.parametrize(("names", "command"), list(list_verbs()))
def test_every_verb_has_an_example_that_can_be_typed(names, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command.epilog, "give it epilog=show_example(...)"
    example = command.epilog.removeprefix("Example: `").removesuffix("`")
    words = shlex.split(example)
    assert words[: 1 + len(names)] == ["softfinger", *names]
    command.make_context(words[0], words[1 + len(names) :])  # refuses an unknown option
    said = CliRunner().invoke(app, [*names, "--help"])
    assert said.exit_code == 0
    assert "Example:" in said.stdout


def test_the_hash_of_one_verb_has_no_other_verb_in_it():
    callbacks = {c.callback.__module__ for c in app.registered_commands}
    assert callbacks <= {f"softfinger.cli.{name}" for name in cli.__all__}
    assert "softfinger/cli/new.py" not in find_modules("softfinger.cli", "softfinger.cli.diagnose")


def test_the_version_is_the_packages():
    assert CliRunner().invoke(app, ["--version"]).stdout == f"softfinger {version('softfinger')}\n"


@pytest.mark.parametrize(
    ("arguments", "status"),
    [(["effects"], 0), (["effects", "nothing"], 1), (["effect"], 2), (["check"], 2)],
)
def test_exit_status_of_a_program(call_here, arguments, status):
    assert call_here(*arguments).status == status


def test_a_refused_campaign_is_a_document_for_programs(tmp_path):
    (tmp_path / "campaign.yaml").write_text("version: 1\nnmae: x\n")
    (tmp_path / "trials.csv").write_text("trial,angles\n")
    done = CliRunner().invoke(app, ["check", str(tmp_path), "--json"])
    assert done.exit_code == 1
    assert any("did you mean 'name'" in fault for fault in json.loads(done.stdout)["faults"])


@pytest.mark.parametrize(
    ("words", "word", "offered"),
    [("softfinger eff", 1, "effects"), ("softfinger effects gra", 2, "gravity")],
)
def test_the_shell_completes_verbs_and_ids(words, word, offered):
    asked = {"_SOFTFINGER_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(word)}
    code = "import sys; sys.argv[0] = 'softfinger'; from softfinger.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | asked, capture_output=True, text=True
    )
    assert done.stdout.split() == [offered]
