"""The motion's spread from the parameters' spread.

It is given as bands, densities and Sobol indices.

The paper's joint is a sum of three parts under any load history: the elastic part of (k_v, c_v),
the flow of c_p and q_ini. Its moments, indices and densities are therefore exact up to quadratures
of one or two dimensions. Every other model takes the sampled route to the same answers (`routes`).
"""

from softfinger.propagation.bands import compute_bands
from softfinger.propagation.densities import compute_densities
from softfinger.propagation.shapley import compute_shapley
from softfinger.propagation.sobol import compute_sobol

__all__ = ["compute_bands", "compute_densities", "compute_shapley", "compute_sobol"]
