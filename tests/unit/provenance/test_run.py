from softfinger.provenance import derive_seed, describe_run


def test_inputs_and_parameters_are_stamped(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("1")
    run = describe_run("check_artifacts", {"tables": [file, file], "one": file}, {"a": 1}, 7)
    file.write_text("2")
    other = describe_run("check_artifacts", {"tables": [file, file], "one": file}, {"a": 2}, 7)
    assert run.inputs["tables"] != other.inputs["tables"]
    assert run.inputs["one"] != run.inputs["tables"]
    assert run.params_sha256 != other.params_sha256
    assert run.code_sha256 == other.code_sha256
    assert str(tmp_path) not in str(run.to_attrs())


def test_stages_draw_from_streams_of_their_own():
    seeds = {derive_seed(s, stage) for s in (0, 1) for stage in ("fit", "sobol")}
    assert len(seeds) == 4
