"""The page of what the recordings suffer from, and the laws that they ask for."""

import numpy as np
import pytest
from example_artifacts import gather

from softfinger.figures.measurement import draw_measurement
from softfinger.report.overview.measurement import build_measurement
from softfinger.report.pictures.measurement import picture_laws, picture_measurement
from softfinger.report.sections.measured import build_measured
from softfinger.report.sections.mismatch import build_form_table


@pytest.fixture
def found(diagnosed):
    return gather(diagnosed)


def test_each_trial_is_summed_up(found):
    noise = found.find("noise")
    np.testing.assert_allclose(noise["gross_share"], [0, 4 / 41, 0, 0, 0])
    assert (noise["repeated_share"] == 0).all()
    assert (noise["saturated_share"] == 0).all()
    np.testing.assert_allclose(noise["noise_ratio"].sel(joint=2), [1, 3, 1, 1, 1])
    last = noise["grown_sd"].isel(deflection=-1)
    np.testing.assert_allclose(last, 0.002 * np.sqrt(5.0))


def test_noise_that_grows_with_the_speed_has_a_panel_of_its_own(found):
    noise = found.find("noise")
    np.testing.assert_allclose(noise["fast_sd"].isel(speed=-1), 0.002)
    assert len(draw_measurement(noise, "mrad").axes) == 3
    faster = noise.assign(fast_sd=noise["fast_sd"] * (1.0 + noise["speed"]))
    axes = draw_measurement(faster, "mrad").axes
    assert axes[3].get_xlabel() == "speed [rad/s]"
    np.testing.assert_allclose(axes[3].lines[0].get_ydata()[[0, -1]], [2.0, 4.0])


def test_every_finding_has_its_size_and_its_evidence(found):
    first, findings, noise = build_measured(found).blocks
    assert first.text.startswith("1 finding.")
    assert [cell.text for cell in findings.rows[0][:5]] == ["outliers", "0.01", "share", "31", "1"]
    assert [cell.text for cell in noise.rows[1]] == ["2", "2", "0.3", "12"]
    picture = build_measurement(found).blocks[1]
    assert picture.name == "measurement"


def test_without_a_diagnosis_the_page_says_so(material):
    (only,) = build_measured(material).blocks
    assert "was not run" in only.text
    assert picture_measurement(material) is None
    assert picture_laws(material) is None


def test_a_panel_for_each_effect_with_a_law(found):
    axes = picture_laws(found).figure.axes
    assert [ax.get_title(loc="left") for ax in axes] == ["moment arm", "strain stiffening"]
    assert [text.get_text() for ax in axes for text in ax.get_legend().get_texts()] == [
        "all joints",
        "joint 2",
    ]
    assert axes[0].get_xlabel() == "angle [rad]"


def test_textbook_forms_are_held_against_the_law(diagnosed):
    verdict = diagnosed["verdict"]
    assert build_form_table(verdict) == []
    (effect,) = verdict["effects"]
    law = {"forms_nats": {"two_lines": -12.5}}
    (table,) = build_form_table({**verdict, "effects": [{**effect, "law": law}]})
    assert [cell.text for cell in table.rows[0]] == ["second retardation", "two lines", "−12.5"]
