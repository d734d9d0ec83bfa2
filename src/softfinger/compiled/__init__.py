"""Compilation with numba, cached on disk.

The cache is never older than its source. Numba's own cache looks at the file of one function alone:
after a change in a function that it calls, it would go on running the old one.
"""

from softfinger.compiled.decorator import compiled
from softfinger.compiled.digest import digest_function

__all__ = ["compiled", "digest_function"]
