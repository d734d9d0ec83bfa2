"""Calls of compiled functions by address.

Neither caller nor function is compiled for the other. A caller takes addresses as numbers, so its
machine code is the same whatever functions they are, and a function that is edited is compiled
alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import cgutils, types
from numba.core.typing.templates import Signature
from numba.extending import intrinsic


def build_call(signature: Signature) -> Callable:
    """Build the call of functions of a signature.

    Compiled code calls it with (address, *arguments). An error that the function raises goes on to
    the caller. An address that is not one of `find_address` ends the process.
    """
    result, expected = signature.return_type, signature.args

    @intrinsic
    def call(_: Any, address: types.Type, *arguments: types.Type) -> tuple | None:  # noqa: ANN401
        """Call the function at an address."""
        if len(arguments) != len(expected):
            return None

        def lower(context: Any, builder: Any, given: Signature, values: list) -> Any:  # noqa: ANN401
            convention = context.call_conv
            face = convention.get_function_type(result, expected)
            pointer = builder.inttoptr(values[0], face.as_pointer())
            parts = cgutils.unpack_tuple(builder, values[1])
            cast = [
                context.cast(builder, part, kind, wanted)
                for part, kind, wanted in zip(parts, given.args[1], expected, strict=True)
            ]
            status, value = convention.call_function(builder, pointer, result, expected, cast)
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return value

        return result(types.int64, types.StarArgTuple.from_types(arguments)), lower

    return call


def find_address(function: Callable, signature: Signature) -> int:
    """Address of a function's machine code for a signature.

    Parameters
    ----------
    function
        Of `compiled`; it must live as long as the address is used.
    """
    function.compile(signature)
    code = function.get_compile_result(signature)
    return code.library.get_pointer_to_function(code.fndesc.llvm_func_name)
