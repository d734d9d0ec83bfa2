import numpy as np
import pytest

from softfinger.figures.assumptions import draw_assumptions


@pytest.fixture
def found(artifacts):
    return artifacts["assumptions"]


def test_panels_hold_the_gaps_the_growth_and_the_changes(found, find):
    figure = draw_assumptions(found, find("assumptions"))
    assert [ax.get_title(loc="left") for ax in figure.axes[:3]] == ["joint 1", "joint 2", "joint 3"]
    gaps = {line.get_label(): line for line in figure.axes[1].get_lines()}
    expected = found["gap_rms_at"].sel(joint=2, cause="moment_arm")
    np.testing.assert_allclose(gaps["moment arm grows, rms"].get_ydata(), 1e3 * expected)
    curve, reached = figure.axes[3].get_lines()
    np.testing.assert_allclose(curve.get_ydata(), 100 * found["arm_growth"])
    np.testing.assert_allclose(reached.get_ydata(), 100 / 6)
    ticks = [tick.get_text() for tick in figure.axes[4].get_xticklabels()]
    assert ticks[:3] == ["$k_v$, 1", "$k_v$, 2", "$k_v$, 3"]
    points = [line for line in figure.axes[4].get_lines() if line.get_marker() == "o"]
    assert len(points) == 3
    np.testing.assert_allclose(points[2].get_ydata(), -20.0)
