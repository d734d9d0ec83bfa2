import numpy as np
import pytest

from softfinger.faults import Fault, ListedFault
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.measurement_file import HumEntry, MeasurementEntry
from softfinger.mechanics.effects.model_file import (
    FittedTo,
    build_model,
    describe_model,
    read_model_file,
    read_strength,
    write_model_file,
)

SETTING = Setting(
    trials=5, joints=3, interval=0.05, duration=10.0, torque=0.04, reversals=True, levels=True,
    rests=True, load_known=True, tension=True, stiffness=np.array([0.1, 0.12, 0.2]),
    reach=np.array([0.5, 0.4, 0.3]), number=np.arange(5.0), memory=np.zeros((5, 3)),
    largest_torque=np.full(5, 0.04),
    rest_time=np.full(5, np.nan),
)  # fmt: skip
TEXT = """\
version: 1
joint: three_element
torque: constant_arm
effects:
- id: second_retardation
  form: own_compliance
  joints: [2, 3]
  priors:
    compliance_share_3: {mean: 0.2, sd: 0.02}
    retardation_time_s: {median: 4.0, log_sd: 0.1}
- {id: camera_delay, form: constant, joints: [], priors: {delay_s: {mean: 0.02, sd: 0.01}}}
fitted_to: {campaign: a rig, sha256: %s}
""" % ("ab" * 32)


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "model.yaml"
        path.write_text(text)
        return path

    return write


def test_a_model_file_says_which_physics_and_how_strong(write):
    content = read_model_file(write(TEXT))
    model = build_model(content, SETTING)
    assert [piece.label for piece in model.pieces] == [
        "second_retardation/own_compliance/2,3",
        "camera_delay/constant",
    ]
    strength = dict(zip([e.name for e in model.entries], read_strength(model), strict=True))
    assert strength["compliance_share_3"] == 0.2
    assert strength["compliance_share_2"] == 0.0
    assert np.exp(strength["retardation_time_s"]) == pytest.approx(4.0)
    assert content.was_fitted_to("ab" * 32)
    assert not content.was_fitted_to("cd" * 32)
    usual = build_model(content, SETTING, priors=False).shared_prior[1]
    assert not np.allclose(usual, model.shared_prior[1])


def test_a_fitted_model_returns_from_its_file(write, tmp_path):
    model = build_model(read_model_file(write(TEXT)), SETTING)
    mean, sd = np.array([0.1, 0.3, np.log(5.0), 0.01]), np.array([0.01, 0.02, 0.1, 0.004])
    content = describe_model(model, mean, np.diag(sd**2), FittedTo(campaign="b", sha256="0" * 64))
    write_model_file(content, tmp_path / "one.yaml")
    again = read_model_file(tmp_path / "one.yaml")
    assert again.model_dump() == content.model_dump()
    found = build_model(again, SETTING).shared_prior
    np.testing.assert_allclose(found, [mean, sd], rtol=1e-6)
    write_model_file(again, tmp_path / "two.yaml")
    assert (tmp_path / "one.yaml").read_bytes() == (tmp_path / "two.yaml").read_bytes()


def test_how_effects_differ_between_trials_returns_from_its_file(write, tmp_path):
    text = TEXT.replace("joints: [2, 3]", "joints: [2, 3]\n  spreads: {compliance_share: 0.3}")
    content = read_model_file(write(text))
    assert content.spreads == {"second_retardation:compliance_share": 0.3}
    model, p = build_model(content, SETTING), 4
    again = describe_model(model, np.ones(p), np.eye(p), None, content.spreads)
    assert [entry.spreads for entry in again.effects] == [{"compliance_share": 0.3}, {}]
    write_model_file(again, tmp_path / "one.yaml")
    assert (tmp_path / "one.yaml").read_text().count("spreads") == 1
    assert read_model_file(tmp_path / "one.yaml").spreads == content.spreads


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("joints: [2, 3]", "{size: 0.1}", "'size' has no spread between trials; there are compl"),
        ("constant, joints: []", "{delay_s: 0.1}", "'delay_s' has .*; nothing of this effect has"),
    ],
)
def test_a_spread_of_what_does_not_differ_is_refused(write, old, new, said):
    mark = "\n  " if old.startswith("joints") else ", "
    content = read_model_file(write(TEXT.replace(old, f"{old}{mark}spreads: {new}")))
    with pytest.raises(ListedFault, match=said):
        build_model(content, SETTING)


def test_what_recordings_suffer_from_returns_from_its_file(write, tmp_path):
    known = MeasurementEntry(
        steady_load=True,
        clock_rate=-0.0012,
        hums=[HumEntry(frequency_hz=7.3, cosine_rad={"a": [1e-3]}, sine_rad={"a": [-2e-3]})],
        disturbances={"drift": 1.0 / 3.0},
    )
    content = read_model_file(write(TEXT)).model_copy(update={"measurement": known.shorten()})
    write_model_file(content, tmp_path / "one.yaml")
    again = read_model_file(tmp_path / "one.yaml").measurement
    assert again.disturbances == {"drift": 0.3333333}
    assert again.hums == known.hums
    assert again.steady_load
    assert again.clock_rate == -0.0012
    assert MeasurementEntry().shorten() is None
    write_model_file(read_model_file(write(TEXT)), tmp_path / "two.yaml")
    assert "measurement" not in (tmp_path / "two.yaml").read_text()


def test_a_disturbance_that_nobody_knows_is_refused(write):
    with pytest.raises(ListedFault, match=r"line 13, measurement.disturbances.magic"):
        read_model_file(write(TEXT + "measurement: {disturbances: {magic: 1.0}}\n"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("id: second_retardation", "id: magic", "unknown effect; there are second_retardation"),
        ("form: own_compliance", "form: square", "no form 'square' here; there are proportional"),
        ("joints: [2, 3]", "joints: [2, 4]", r"joints are \[2, 4\]; expected different joints of"),
        ("joints: [2, 3]", "joints: []", r"joints are \[\]; expected different joints of 3"),
        ("compliance_share_3", "compliance_share_1", "no parameter 'compliance_share_1'"),
        ("median: 4.0, log_sd", "mean: 4.0, sd", "the prior of retardation_time_s needs median"),
        ("id: camera_delay, form: constant", "id: gravity, form: along", "cannot have it"),
    ],
)
def test_what_a_campaign_does_not_have_is_refused(write, old, new, message):
    content = read_model_file(write(TEXT.replace(old, new)))
    with pytest.raises(ListedFault, match=message):
        build_model(content, SETTING)


def test_every_fault_of_a_file_is_listed(write, tmp_path):
    broken = TEXT.replace("version: 1", "version: 2").replace("torque: constant_arm", "tork: x")
    with pytest.raises(ListedFault, match=r"version(.|\n)*torque(.|\n)*tork"):
        read_model_file(write(broken))
    with pytest.raises(Fault, match="it is not YAML"):
        read_model_file(write("effects: [}"))
    with pytest.raises(Fault, match="does not exist"):
        read_model_file(tmp_path / "absent.yaml")


def test_an_effect_without_strength_cannot_be_simulated(write):
    text = TEXT.replace("priors: {delay_s: {mean: 0.02, sd: 0.01}}", "priors: {}")
    with pytest.raises(Fault, match="gives camera_delay no strength: add priors for delay_s"):
        read_strength(build_model(read_model_file(write(text)), SETTING))


def test_a_refusal_names_the_file_and_the_line(write):
    path = write(TEXT.replace("second_retardation", "another"))
    with pytest.raises(
        ListedFault, match=r"line 5, effect 1 \(another\): unknown effect"
    ) as caught:
        build_model(read_model_file(path), SETTING)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("prior", "said"),
    [
        ("{median: 4.0, unit: min}", "retardation_time_s.unit: this key is unknown"),
        ("{median: 4.0}", "retardation_time_s.log_sd: this key is missing"),
        ("{mean: 4.0, sd: -1}", "retardation_time_s.sd: is '-1'; input should be greater than 0"),
        ("4.0", "retardation_time_s: expected keys, as in"),
    ],
)
def test_a_wrong_prior_is_refused_in_one_sentence(write, prior, said):
    path = write(TEXT.replace("{median: 4.0, log_sd: 0.1}", prior))
    with pytest.raises(ListedFault, match=f"line 10, effects.0.priors.{said}"):
        read_model_file(path)


def test_a_model_of_other_recordings_has_a_note(write):
    content = read_model_file(write(TEXT))
    assert content.describe_origin("ab" * 32) is None
    said = content.describe_origin("cd" * 32)
    assert "it was fitted to other recordings (campaign 'a rig')" in said
