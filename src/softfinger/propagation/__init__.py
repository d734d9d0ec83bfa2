"""How the spread of the parameters becomes spread of the motion: bands, densities, Sobol indices.

The paper's joint is a sum of three independent parts under any load history: the elastic part of
(k_v, c_v), the flow of c_p and q_ini. Its moments, indices and densities are therefore exact up to
quadratures of one or two dimensions. Other forward models take the sampling routes of `general`.
"""
