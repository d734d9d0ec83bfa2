"""Linear algebra on one thread.

Draws then do not depend on the number of cores.

How BLAS splits a product among its threads changes the last digits, and a chain of NUTS doubles
such a difference every few steps. Loops that numba compiles keep their threads.
"""

from threadpoolctl import threadpool_limits

on_one_thread = threadpool_limits.wrap(limits=1, user_api="blas")
