"""The paper's population of fingers, and its trials.

References
----------
Honji, Arita, Tahara, "Stochastic Approach for Modeling the Soft Finger with the Creep Behavior",
table of the fitted log-normal distributions. ASSUME: two things are not from the table. Joint 3's
c_p follows log-normal(3.3, 0.9), because the printed sd of 3.23 gives joint angles of 60 rad on
average; q_ini, whose numbers are not printed, follows N(0.02, 0.01) rad.
"""

import numpy as np
import xarray as xr

from softfinger.mechanics import PARAMETERS
from softfinger.virtual_rig.streams import Purpose, build_generator

JOINTS = (1, 2, 3)

# (joint, parameter); of the logarithm for k_v [N m/rad], c_v, c_p [N m s/rad], natural for q_ini
POPULATION_MEAN = np.array(
    [
        [-2.4441, -3.6635, 2.8538, 0.02],
        [-2.2986, -3.6476, 3.1129, 0.02],
        [-1.8800, -3.8777, 3.3, 0.02],
    ]
)
POPULATION_SD = np.array(
    [
        [0.1973, 0.5232, 0.7011, 0.01],
        [0.2238, 0.4838, 0.8496, 0.01],
        [0.3957, 0.8223, 0.9, 0.01],
    ]
)


def build_trial_names(n_trials: int) -> list[str]:
    """Name the trials in recording order.

    >>> build_trial_names(2)
    ['trial_001', 'trial_002']
    """
    return [f"trial_{number:03d}" for number in range(1, n_trials + 1)]


def draw_finger_parameters(n_trials: int, seed: int) -> xr.Dataset:
    """Draw the true parameters of every trial.

    They are independent between parameters, joints and trials.

    log k_v, log c_v, log c_p ~ N(mean, sd²) and q_ini ~ N(mean, sd²), per joint.

    Parameters
    ----------
    n_trials
        Number of trials; the first ones do not depend on it.
    seed
        Root of the trials' streams.

    Returns
    -------
    Dataset
        k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad] (trial, joint); population_mean and
        population_sd (joint, parameter).
    """
    deviation = np.stack(
        [
            build_generator(seed, index, Purpose.PARAMETERS).standard_normal(POPULATION_MEAN.shape)
            for index in range(n_trials)
        ]
    )
    drawn = POPULATION_MEAN + POPULATION_SD * deviation  # (trial, joint, parameter)
    drawn[..., :3] = np.exp(drawn[..., :3])
    return xr.Dataset(
        {name: (("trial", "joint"), drawn[..., i]) for i, name in enumerate(PARAMETERS)}
        | {
            "population_mean": (("joint", "parameter"), POPULATION_MEAN),
            "population_sd": (("joint", "parameter"), POPULATION_SD),
        },
        coords={
            "trial": build_trial_names(n_trials),
            "joint": list(JOINTS),
            "parameter": list(PARAMETERS),
        },
    )
