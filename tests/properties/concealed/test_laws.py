"""What must hold for any load, any parameters, any noise."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.campaign.load_log import build_load_array
from softfinger.concealed.effects import Circumstances
from softfinger.concealed.forward import compute_plain_angles
from softfinger.concealed.noise import Noise, whiten
from softfinger.concealed.population import PAPER_MEAN, PAPER_SD
from softfinger.concealed.protocols import Load, write_rows

TIME = np.linspace(0.0, 20.0, 101)


@st.composite
def loads(draw):
    """Jumps and ramps, the first at 0 or later."""
    time, tension, now = [], [], draw(st.sampled_from([0.0, 0.7]))
    before = 0.0
    for _ in range(draw(st.integers(1, 5))):
        level = draw(st.integers(0, 9)) + 0.5
        if draw(st.booleans()) or not time:
            time += [now, now]
            tension += [before, level]
        else:
            time.append(now)
            tension.append(level)
        before, now = level, now + draw(st.integers(1, 5))
    return Load(np.array(time), np.array(tension))


def _trial(load):
    return Circumstances(0, 1, load, 20.0, 0.0, 10.0, (0.5, 0.5, 0.5))


individuals = st.integers(0, 10_000).map(
    lambda seed: PAPER_MEAN + PAPER_SD * np.random.default_rng(seed).normal(size=PAPER_MEAN.shape)
)


@settings(deadline=None)
@given(loads())
def test_a_written_log_is_read_as_the_load_that_acted(load):
    rows = write_rows(load)
    time, tension = build_load_array(rows[:, 0], rows[:, 1], 1.5 * 0.05)
    probe = np.setdiff1d(np.linspace(-0.5, 25.0, 499), load.time)
    np.testing.assert_allclose(Load(time, tension).value(probe), load.value(probe), atol=1e-9)


@settings(deadline=None)
@given(loads(), individuals)
def test_the_plain_finger_is_linear_in_the_load(load, individual):
    once = compute_plain_angles(individual, _trial(load), 0.005, TIME) - individual[3]
    thrice = compute_plain_angles(individual, _trial(load), 0.015, TIME) - individual[3]
    np.testing.assert_allclose(thrice, 3.0 * once, rtol=1e-9, atol=1e-12)


@settings(deadline=None)
@given(loads(), individuals)
def test_the_plain_finger_never_bends_against_a_pull(load, individual):
    angle = compute_plain_angles(individual, _trial(load), 0.005, TIME)
    assert np.all(angle - individual[3] >= -1e-12)
    assert np.all(angle[load.time[0] > TIME] == individual[3])


@settings(deadline=None)
@given(st.sampled_from(["white", "ar_0.9", "uneven"]), st.integers(0, 1000), st.floats(-3.0, 3.0))
def test_whitening_is_linear(kind, seed, factor):
    rng = np.random.default_rng(seed)
    noise, time = Noise(kind, 0.002, 0.05), np.cumsum(rng.uniform(0.02, 0.3, 17))
    a, b = rng.normal(size=(2, 17, 3))
    np.testing.assert_allclose(
        whiten(noise, time, a + factor * b),
        whiten(noise, time, a) + factor * whiten(noise, time, b),
        rtol=1e-6,
        atol=1e-6,
    )
