"""The paper's table of fitted log-normal distributions.

They are of the parameters of its finger.

Honji, Arita, Tahara, "Stochastic Approach for Modeling the Soft Finger with the Creep Behavior".
μ and σ of ln k_v [N m/rad], ln c_v and ln c_p [N m s/rad]; its numbers for q_ini are not printed.
"""

import numpy as np
import xarray as xr

_MU = [
    [-2.4441, -3.6635, 2.8538, np.nan],
    [-2.2986, -3.6476, 3.1129, np.nan],
    [-1.8800, -3.8777, 1.3114, np.nan],
]
_SIGMA = [
    [0.1973, 0.5232, 0.7011, np.nan],
    [0.2238, 0.4838, 0.8496, np.nan],
    [0.3957, 0.8223, 3.2316, np.nan],
]


def build_paper_table() -> xr.DataArray:
    """Build the paper's table (statistic, joint, parameter).

    >>> float(build_paper_table().sel(statistic="sigma", joint=3, parameter="c_p"))
    3.2316
    """
    return xr.DataArray(
        np.array([_MU, _SIGMA]),
        dims=("statistic", "joint", "parameter"),
        coords={
            "statistic": ["mu", "sigma"],
            "joint": [1, 2, 3],
            "parameter": ["k_v", "c_v", "c_p", "q_ini"],
        },
    )
