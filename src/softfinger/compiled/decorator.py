"""The decorator of every compiled function of the project."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import overload

from numba import njit

from softfinger.compiled.cache import SourceCache
from softfinger.compiled.shapes import shorten_errors

shorten_errors()


@overload
def compiled[F: Callable](function: F, /) -> F: ...
@overload
def compiled[F: Callable](*, signature: object = None, **options: object) -> Callable[[F], F]: ...
def compiled(
    function: Callable | None = None, /, *, signature: object = None, **options: object
) -> Callable:
    """Compile a function with numba and keep it.

    It is compiled anew if its own code changes, or that of a function that it calls, or a constant
    or class that it uses. Comments, docstrings and other functions of the same file do not count.
    It runs without Python's lock, so trials can run side by side.

    Parameters
    ----------
    function
        A function of what numba knows.
    signature
        Numba's signature, to compile for it at once and for no other; without it the function is
        compiled at its first call, for the types that it is given.
    **options
        As `numba.njit` takes them: `error_model`, `inline` and others.

    Examples
    --------
    In a module, for only a function with a file of its own is remembered:

    >>> @compiled(error_model="numpy")  # doctest: +SKIP
    ... def halve(a):
    ...     return a / 2
    """
    if function is None:
        return partial(compiled, signature=signature, **options)
    dispatcher = njit(nogil=True, **options)(function)
    if dispatcher is function:  # where NUMBA_DISABLE_JIT is set
        return function
    dispatcher._cache = SourceCache(dispatcher)
    if signature is not None:
        dispatcher.compile(signature)
        dispatcher.disable_compile()
    return dispatcher
