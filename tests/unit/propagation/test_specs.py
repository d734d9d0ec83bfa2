"""What the stage computes is what its artifacts declare."""

import numpy as np
import pytest

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs import bands, densities, shapley, sobol
from softfinger.inference.motion import move_paper_joint
from softfinger.propagation import (
    compute_bands,
    compute_densities,
    compute_shapley,
    compute_sobol,
)

ARTIFACTS = {
    compute_bands: bands,
    compute_densities: densities,
    compute_sobol: sobol,
    compute_shapley: shapley,
}


def move_softly(*fingers):
    """An effect that couples what the parameters do: the angle saturates."""
    return 0.5 * np.tanh(2 * move_paper_joint(*fingers))


@pytest.fixture(params=ARTIFACTS, ids=lambda compute: compute.__name__)
def compute(request, angles, least_squares, posterior, config):
    def run(move):
        inputs = (angles, posterior) if request.param is compute_shapley else (
            angles, least_squares, posterior
        )  # fmt: skip
        return request.param(*inputs, config, np.random.default_rng(3), move)

    run.spec = ARTIFACTS[request.param].SPEC
    return run


def test_with_and_without_effects_the_artifact_has_the_same_content(compute):
    base, other = compute(move_paper_joint), compute(move_softly)
    for found in (base, other):
        assert list_faults(compute.spec, found) == []
    assert dict(other.sizes) == dict(base.sizes)
    assert {n: v.dims for n, v in other.variables.items()} == {
        n: v.dims for n, v in base.variables.items()
    }
    assert sorted(other.attrs) == sorted(base.attrs)
    assert all(np.isfinite(other[name]).any() for name in other if other[name].dtype.kind == "f")
