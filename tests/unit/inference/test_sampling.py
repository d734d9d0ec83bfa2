"""Ctrl-C while chains are drawn."""

import os
import signal

import numpy as np
import nutpie
import pytest

from softfinger.inference.sampling import wait_for_draws

SIZE = 3


@pytest.fixture
def ctrl_c():
    """Where the tests run in the background of a shell, Ctrl-C has been switched off."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def sample(count_to):
    evaluations = 0

    def log_density(x):
        nonlocal evaluations
        evaluations += 1
        if evaluations == count_to:
            os.kill(os.getpid(), signal.SIGINT)
        return -0.5 * float(x @ x), -x

    model = nutpie.compiled_pyfunc.from_pyfunc(
        SIZE,
        lambda: log_density,
        lambda *_: lambda x: {"point": x},
        [np.dtype(float)],
        [(SIZE,)],
        ["point"],
        dims={"point": ("value",)},
        coords={"value": np.arange(SIZE)},
        make_initial_point_fn=lambda _: np.ones(SIZE),
    )
    return nutpie.sample(
        model, draws=500, tune=100, chains=2, cores=2, seed=1, save_warmup=False,
        progress_bar=False, blocking=False,
    )  # fmt: skip


def test_all_draws_are_waited_for():
    assert wait_for_draws(sample(-1))["posterior"]["point"].shape == (2, 500, SIZE)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_sampling_and_no_draws_are_kept():
    with pytest.raises(KeyboardInterrupt):
        wait_for_draws(sample(900))
