"""PyTensor operations that are one numba function each."""

from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np
import pytensor.tensor as pt
from pytensor.graph.basic import Apply, Variable
from pytensor.graph.op import Op
from pytensor.link.numba.dispatch.basic import (
    numba_njit,
    register_funcify_default_op_cache_key,
)

from softfinger.compiled import digest_function

own = np.ascontiguousarray  # linear algebra wants whole rows


class CompiledOperation(Op):
    """An operation that is one numba function of arrays.

    `run` is that function for arrays of any layout, which is how PyTensor types them.
    """

    __props__ = ()
    function: ClassVar[Callable]
    run: ClassVar[Callable]

    def __init_subclass__(cls) -> None:
        """Have PyTensor compile a new kind by numba."""
        register_funcify_default_op_cache_key(cls)(_compile)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, self.type_outputs(*variables))

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """Variables of the outputs, one for each."""
        raise NotImplementedError

    def perform(self, node: Apply, inputs: Sequence, output_storage: Sequence) -> None:
        """Evaluate with numpy arrays."""
        results = type(self).function(*(np.ascontiguousarray(x) for x in inputs))
        if len(output_storage) == 1:
            results = (results,)
        for storage, result in zip(output_storage, results, strict=True):
            storage[0] = np.asarray(result)


def _compile(op: CompiledOperation, **_: object) -> tuple[Callable, int]:
    key = digest_function(type(op).run)  # PyTensor's own cache sees only names
    return numba_njit(type(op).run), int(key[:15], 16)
