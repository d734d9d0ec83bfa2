"""The collapsed likelihood against the density of all frames at once, written anew."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from softfinger.population.collapse import collapse_angles
from softfinger.population.frames import select_frames
from softfinger.population.likelihood import compute_log_likelihood_array
from softfinger.population.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.population.windows import localise_collapse

TRIALS, JOINTS, TORQUE = 2, 3, 0.04
SD, RHO = np.array([0.002, 0.003, 0.004]), np.array([0.3, 0.5, 0.9])
CORRELATION = np.array([[1.0, -0.4, 0.0], [-0.4, 1.0, -0.3], [0.0, -0.3, 1.0]])
MEAN, SPREAD = np.array([-2.3, -3.6, 3.0, 0.02]), np.array([0.3, 0.5, 0.8, 0.01])


def sum_directly(time, angle, eta):
    """Normal density of every frame and joint: AR(1) per joint, innovations correlated."""
    k_v, c_v, c_p = np.exp(eta[:, :3].T)[..., None]
    motion = TORQUE / k_v * -np.expm1(-k_v / c_v * time) + TORQUE / c_p * time + eta[:, 3:]
    lag = np.abs(np.subtract.outer(np.arange(time.size), np.arange(time.size)))
    fresh = np.sqrt(1 - RHO**2)
    level = np.outer(SD * fresh, SD * fresh) * CORRELATION / (1 - np.outer(RHO, RHO))
    later = np.arange(time.size)[:, None] > np.arange(time.size)
    blocks = [
        [level[j, k] * np.where(later, RHO[j] ** lag, RHO[k] ** lag) for k in range(JOINTS)]
        for j in range(JOINTS)
    ]
    return multivariate_normal.logpdf((angle - motion).ravel(), cov=np.block(blocks))


@pytest.mark.parametrize("frames", [40, 300])
def test_collapsed_and_direct_sum_agree_within_1e_5_nats(frames):
    rng = np.random.default_rng(frames)
    time = np.arange(frames) * 30.0 / frames
    recording = build_recording(time, [0.0, 30.0], [TORQUE] * 2, JOINTS, ["a", "b"])
    own = draw_parameters(MEAN, SPREAD, recording, rng)
    noise = describe_noise(SD, RHO).assign(noise_correlation=(("joint", "other"), CORRELATION))
    angles = draw_angles(recording, own, noise, rng)
    collapse = collapse_angles(angles, select_frames(angles))
    eta = np.stack([np.log(own[k]) for k in ("k_v", "c_v", "c_p")] + [own["q_ini"]], axis=-1)
    eta = eta + 0.01 * rng.standard_normal(eta.shape)
    direct = [sum_directly(time, angles["joint_angle"].values[i], eta[i]) for i in range(TRIALS)]
    x = eta[..., 0] - eta[..., 1]
    for limits in ((), (x - 0.3, x + 0.5)):
        local = localise_collapse(collapse, *limits)
        collapsed = compute_log_likelihood_array(local, eta, SD, RHO, CORRELATION)
        assert np.abs(collapsed - direct).max() < 1e-5
