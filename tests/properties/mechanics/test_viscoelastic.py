import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.mechanics.viscoelastic.elements import (
    Dashpot,
    Spring,
    Springpot,
    compute_regular_stiffness,
    compute_transfer_function,
    is_fractional,
    parallel,
    series,
)
from softfinger.mechanics.viscoelastic.laplace import invert_laplace_array
from softfinger.mechanics.viscoelastic.response import (
    compute_creep_compliance_array,
    compute_relaxation_modulus_array,
)

values = st.floats(-3.0, 3.0).map(np.exp)
leaves = st.builds(Spring, values) | st.builds(Dashpot, values)
pots = st.builds(Springpot, values, st.floats(0.1, 0.9))


def networks(leaf):
    def grow(children):
        parts = st.lists(children, min_size=2, max_size=3)
        return parts.map(lambda p: series(*p)) | parts.map(lambda p: parallel(*p))

    return st.recursive(leaf, grow, max_leaves=7)


TIME = np.geomspace(1e-3, 1e3, 13)


@settings(deadline=None)
@given(networks(leaves))
def test_partial_fractions_agree_with_the_contour(network):
    creep = compute_creep_compliance_array(network, TIME)
    contour = invert_laplace_array(lambda s: compute_transfer_function(network, s) / s, TIME)
    np.testing.assert_allclose(creep, contour, rtol=1e-9)
    relaxation = compute_relaxation_modulus_array(network, TIME)[1]
    contour = invert_laplace_array(lambda s: compute_regular_stiffness(network, s) / s, TIME)
    np.testing.assert_allclose(relaxation, contour, atol=1e-9 * relaxation.max())


@settings(deadline=None)
@given(networks(leaves | pots))
def test_every_network_creeps_on_and_relaxes_on(network):
    creep = compute_creep_compliance_array(network, TIME)
    relaxation = compute_relaxation_modulus_array(network, TIME)[1]
    slack = 1e-9 if is_fractional(network) else 1e-13
    assert (creep > 0.0).all()
    assert (np.diff(creep) >= -slack * creep.max()).all()
    assert (np.diff(relaxation) <= slack * relaxation.max()).all()
    assert (relaxation >= -slack * relaxation.max()).all()


@settings(deadline=None)
@given(networks(leaves | pots), values)
def test_twice_as_stiff_creeps_half_as_far(network, scale):
    def stiffer(element):
        match element:
            case Spring(k):
                return Spring(k * scale)
            case Dashpot(c):
                return Dashpot(c * scale)
            case Springpot(v, a):
                return Springpot(v * scale, a)
        return type(element)(element.kind, tuple(stiffer(part) for part in element.parts))

    np.testing.assert_allclose(
        scale * compute_creep_compliance_array(stiffer(network), TIME),
        compute_creep_compliance_array(network, TIME),
        rtol=1e-9,
    )
