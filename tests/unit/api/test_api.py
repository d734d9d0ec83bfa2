"""The names that programs may rely on: which, and that each is documented and typed."""

import inspect
import typing

import pytest

from softfinger import api
from softfinger.provenance import PROJECT

# A name that goes, or an argument that does, is a new major version: see CHANGELOG.md.
SIGNATURES = {
    "Effect": (
        "id sentence level build_forms part hooks of_motion place place_in_time place_of_one course"
    ),
    "Fault": "said",
    "Form": "name parameters slots covariate local law kin finer lent linear",
    "Law": "name argument reach size terms per kind smooth",
    "Parameter": "name mean sd per log low high amplitude floor starts report term far",
    "Results": "folder",
    "Setting": (
        "trials joints interval duration torque reversals levels rests load_known tension "
        "stiffness reach number memory largest_torque rest_time covariates geometry masses "
        "step_gap camera drift specimen first_seen own_time"
    ),
    "free_form": "law constants form local lent name",
    "list_effects": "",
    "open_results": "folder",
    "positive": "name sd more",
    "read_campaign": "folder",
    "run": "campaign out config cores",
    "signed": "name sd more",
    "time_constant": "name shortest longest starts",
}


def test_the_list_of_names_is_the_pinned_one():
    assert sorted(api.__all__) == sorted(SIGNATURES)
    assert len(SIGNATURES) <= 15


@pytest.mark.parametrize("name", SIGNATURES)
def test_a_name_keeps_its_arguments(name):
    assert " ".join(inspect.signature(getattr(api, name)).parameters) == SIGNATURES[name]


@pytest.mark.parametrize("name", SIGNATURES)
def test_a_name_is_documented_and_typed(name):
    thing = getattr(api, name)
    assert len(inspect.getdoc(thing)) > 20
    function = thing.__init__ if inspect.isclass(thing) else inspect.unwrap(thing)
    hints = function.__annotations__
    assert set(inspect.signature(function).parameters) - {"self"} <= set(hints)
    if not inspect.isclass(thing):
        assert "return" in hints
        assert typing.get_type_hints(function, vars(inspect.getmodule(function)))
    assert f"`{name}`" in (PROJECT / "docs/api.md").read_text(encoding="utf-8")


def test_type_checkers_see_the_types():
    assert (PROJECT / "src/softfinger/py.typed").is_file()


def test_results_are_opened_by_name_and_a_wrong_name_is_a_sentence(tmp_path, monkeypatch):
    with pytest.raises(api.Fault, match="no results are here"):
        api.open_results(tmp_path)
    from typer.testing import CliRunner

    from softfinger.cli import app

    example = str(PROJECT / "data/example")
    CliRunner().invoke(app, ["angles", example, "--out", str(tmp_path)], catch_exceptions=False)
    results = api.open_results(tmp_path)
    assert results.names == ["angles", "doubts"]
    assert dict(results["angles"].sizes)["trial"] == 4
    with pytest.raises(api.Fault, match="no artifact 'bands' is here; there are angles, doubts"):
        results["bands"]


def test_a_run_that_fails_is_a_fault(tmp_path, monkeypatch):
    monkeypatch.setattr("softfinger.cli.campaign.run_workflow", lambda *a: 1)
    with pytest.raises(api.Fault, match=r"a step of the run failed; its log is in .*logs"):
        api.run(PROJECT / "data/example", tmp_path)
