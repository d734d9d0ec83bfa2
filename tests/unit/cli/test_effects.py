"""`softfinger effects`: the catalogue in the terminal, from its own declarations."""

import json

import pytest
from typer.testing import CliRunner

from softfinger.cli import app
from softfinger.cli.effects import complete_effect
from softfinger.cli.text_plot import HEIGHT, plot_text
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.demonstration import describe_finger_of_the_paper
from softfinger.mechanics.effects.effect import FREE, Effect, Form
from softfinger.stages.effects import describe_effect


def run(*arguments):
    return CliRunner().invoke(app, ["effects", *arguments])


def test_every_effect_has_one_line():
    lines = run().stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(list_effects())
    assert all(effect.sentence in run().stdout for effect in list_effects().values())


@pytest.mark.parametrize("name", list_effects())
def test_every_effect_is_described_from_what_it_declares(name):
    effect = list_effects()[name]
    described = describe_effect(effect)
    forms = effect.list_forms(describe_finger_of_the_paper())
    assert list(described.forms) == [form.name for form in forms]
    assert described.place
    assert (described.law is not None) == any(form.name.startswith(FREE) for form in forms)
    assert described.source.endswith(f"{name}.py")


def test_recordings_that_an_effect_needs_are_its_own_refusals():
    needs = describe_effect(list_effects()["wire_friction"]).requires
    assert needs["the wire's tension in the load log"] == "the load is not a wire tension"
    assert "a camera" not in needs
    assert describe_effect(list_effects()["strain_stiffening"]).requires == {}
    helps = describe_effect(list_effects()["wire_friction"]).helps
    assert helps["a load that falls after it has risen"] == 4


def test_an_effect_that_the_papers_finger_cannot_show_is_described():
    effect = Effect("x", "it hums", "within_trial", lambda setting: "only a drum hums")
    assert describe_effect(effect).requires == {"another campaign": "only a drum hums"}


def test_a_form_of_no_parameters_is_described():
    still = Effect("x", "it rests", "within_trial", lambda s: [Form("rest", (), lambda v: {})])
    assert describe_effect(still).forms == {"rest": ()}


def test_one_effect_is_a_document_for_programs():
    said = json.loads(run("gravity", "--json").stdout)
    assert said["id"] == "gravity"
    assert "masses of links" in said["requires"]


def test_a_wrong_id_is_a_sentence_with_the_nearest():
    done = run("gravitiy", "--no-plot")
    assert "did you mean 'gravity'?" in str(done.exception)


def test_ids_complete():
    assert complete_effect("wire") == ["wire_friction"]
    assert complete_effect("load_") == ["load_limit", "load_gain"]


def test_the_picture_is_drawn_and_written(tmp_path):
    done = run("gravity", "--picture", str(tmp_path / "a/gravity.png"))
    assert "joint angle [rad] against time [s]; · without it, ● with it" in done.stdout
    assert done.stdout.count("●") > 40
    assert (tmp_path / "a/gravity.png").read_bytes()[1:4] == b"PNG"


def test_a_text_plot_shows_height_by_row():
    lines = plot_text([0.0, 1.0], {"a": [0.0, 0.0], "b": [0.0, 3.0]}, "x")
    assert lines[0].startswith("     3┤")
    assert lines[0].endswith("bbb")
    assert lines[HEIGHT - 1].startswith("     0┤bbb")
    assert lines[HEIGHT - 1].endswith("aaa")
