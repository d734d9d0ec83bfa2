"""Operations that PyMC lacks, compiled by numba.

They are the likelihood of an expansion, and the whitening.

They are ordinary PyTensor operations with exact derivatives, so any PyMC sampler can use them.
"""

from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np
import pytensor.tensor as pt
from numpy.typing import NDArray
from pytensor.gradient import DisconnectedType
from pytensor.graph.basic import Apply, Variable
from pytensor.graph.op import Op
from pytensor.link.numba.dispatch.basic import (
    numba_njit,
    register_funcify_default_op_cache_key,
)

from softfinger.compiled import compiled, digest_function
from softfinger.inference.expansion import slope_squares
from softfinger.inference.whitening import colour_trials, pull_colours_back, shift_pull
from softfinger.measurement.covariance import factorise_partials, pull_factor_back

own = np.ascontiguousarray  # linear algebra wants whole rows


# Inlined, for the function that PyTensor makes of it is compiled whole again.
@compiled(error_model="numpy", inline="always")
def evaluate_likelihood(
    eta: NDArray,
    effect: NDArray,
    log_scale: NDArray,
    mode: NDArray,
    shared: NDArray,
    gram: NDArray,
    rows: NDArray,
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Sum log p over trials, but for constants.

    Also its slopes by η, φ and the noise's log s.
    """
    square, by_eta, by_effect = slope_squares(eta, effect, mode, shared, gram)
    scale = np.exp(-2.0 * log_scale.item())
    total = rows.sum()
    value = -0.5 * scale * square - total * log_scale.item()
    return (
        np.asarray(value),
        -0.5 * scale * by_eta,
        -0.5 * scale * by_effect,
        np.asarray(scale * square - total),
    )


def _run_likelihood(  # noqa: ANN202
    eta: NDArray, effect: NDArray, log_scale: NDArray, mode: NDArray, shared: NDArray,
    gram: NDArray, rows: NDArray,
):  # fmt: skip
    return evaluate_likelihood(
        own(eta), own(effect), log_scale, own(mode), own(shared), own(gram), own(rows)
    )


def _run_shift(pull: NDArray, cross: NDArray, change: NDArray):  # noqa: ANN202
    return shift_pull(own(pull), own(cross), own(change))


def _run_shift_back(cross: NDArray, pull_bar: NDArray):  # noqa: ANN202
    back = np.zeros(cross.shape[1])
    for a in range(cross.shape[0]):
        for k in range(back.size):
            back[k] -= (cross[a, k] * pull_bar[a]).sum()
    return back


def _run_colours(  # noqa: ANN202
    z: NDArray, curvature: NDArray, pull: NDArray, mean: NDArray, precision: NDArray
):
    return colour_trials(own(z), own(curvature), own(pull), own(mean), own(precision))


def _run_colours_back(  # noqa: ANN202
    eta: NDArray, z: NDArray, factor: NDArray, mean: NDArray, precision: NDArray, eta_bar: NDArray,
    volume_bar: NDArray,
):  # fmt: skip
    return pull_colours_back(
        own(eta), own(z), own(factor), own(mean), own(precision), own(eta_bar), own(volume_bar)
    )


def _run_product(a: NDArray, b: NDArray) -> NDArray:
    product = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            product[i] += a[i, k] * b[k]
    return product


def _run_factor(partial: NDArray):  # noqa: ANN202
    return factorise_partials(own(partial))


def _run_factor_back(partial: NDArray, factor: NDArray, factor_bar: NDArray):  # noqa: ANN202
    return pull_factor_back(own(partial), own(factor), own(factor_bar))


class _Compiled(Op):
    """An operation that is one numba function of arrays.

    `run` is that function for arrays of any layout, which is how PyTensor types them.
    """

    __props__ = ()
    function: ClassVar[Callable]
    run: ClassVar[Callable]

    def perform(self, node: Apply, inputs: Sequence, output_storage: Sequence) -> None:
        """Evaluate with numpy arrays."""
        results = type(self).function(*(np.ascontiguousarray(x) for x in inputs))
        if len(output_storage) == 1:
            results = (results,)
        for storage, result in zip(output_storage, results, strict=True):
            storage[0] = np.asarray(result)


class Multiply(_Compiled):
    """Product of two matrices; PyTensor's own compiles slowly."""

    function = staticmethod(compiled(_run_product))
    run = staticmethod(_run_product)

    def make_node(self, a: Variable, b: Variable) -> Apply:
        """Build the node."""
        return Apply(self, [a, b], [pt.dmatrix()])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [(shapes[0][0], shapes[1][1])]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the product back."""
        a, b = inputs
        return [Multiply()(cotangents[0], b.T), Multiply()(a.T, cotangents[0])]


class ExpandedLikelihood(_Compiled):
    """Log likelihood summed over trials (`expansion`).

    Σ log p(y | η, φ, s), without constants.

    Inputs: eta (d, trial), effect (p,), log of the noise's scale (); then the expansion's own,
    shared, gram, rows. Outputs: the sum and, for its derivatives, its slopes by the first three.
    """

    function = staticmethod(evaluate_likelihood)
    run = staticmethod(_run_likelihood)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node; slopes have their parameters' types."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [pt.dscalar(), *(x.type() for x in variables[:3])])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        return [(), *shapes[:3]]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the sum back."""
        slopes = [cotangents[0] * slope for slope in outputs[1:]]
        return slopes + [DisconnectedType()() for _ in inputs[3:]]

    def connection_pattern(self, node: Apply) -> list[list[bool]]:
        """Only the sum depends on the parameters."""
        return [[k < 3, False, False, False] for k in range(len(node.inputs))]


class ShiftPull(_Compiled):
    """Pull of the stand-in after effects changed (`whitening`).

    Inputs: pull (d, trial), cross (d, p, trial), change φ − φ* (p,). Output: pull (d, trial).
    """

    function = staticmethod(compiled(_run_shift))
    run = staticmethod(_run_shift)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [variables[0].type()])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [shapes[0]]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the shifted pull back."""
        back = ShiftPullBack()(inputs[1], cotangents[0])
        return [cotangents[0], DisconnectedType()(), back]

    def connection_pattern(self, node: Apply) -> list[list[bool]]:
        """`cross` is data."""
        return [[True], [False], [True]]


class ShiftPullBack(_Compiled):
    """The derivative of `ShiftPull` by the change."""

    function = staticmethod(compiled(_run_shift_back))
    run = staticmethod(_run_shift_back)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        return Apply(self, [pt.as_tensor_variable(x) for x in inputs], [pt.dvector()])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [(shapes[0][1],)]


class ColourTrials(_Compiled):
    """The trials' parameters from standard normals (`whitening`).

    The population is given.

    Inputs: z (p, trial), curvature, pull, mean (p,), precision (p, p). Outputs: eta (p, trial),
    log_volume (trial,), and the Cholesky factors for the way back.
    """

    function = staticmethod(colour_trials)
    run = staticmethod(_run_colours)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        z, curvature, *rest = (pt.as_tensor_variable(x) for x in inputs)
        volume = pt.TensorType("float64", z.type.shape[1:])()
        factor = pt.TensorType("float64", (z.type.shape[0], *z.type.shape))()
        return Apply(self, [z, curvature, *rest], [z.type(), volume, factor])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        size, trials = shapes[0]
        return [(size, trials), (trials,), (size, size, trials)]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangents of eta and log_volume back."""
        z, _, _, mean, precision = inputs
        eta, volume, factor = outputs
        bars = [
            pt.zeros_like(out) if isinstance(bar.type, DisconnectedType) else bar
            for out, bar in zip((eta, volume), cotangents[:2], strict=True)
        ]
        z_bar, pull_bar, mean_bar, precision_bar = PullColoursBack()(
            eta, z, factor, mean, precision, *bars
        )
        return [z_bar, DisconnectedType()(), pull_bar, mean_bar, precision_bar]

    def connection_pattern(self, node: Apply) -> list[list[bool]]:
        """Curvature is data; the factor serves `pullback` only."""
        return [[k != 1, k != 1, False] for k in range(5)]


class PullColoursBack(_Compiled):
    """The derivative of `ColourTrials`."""

    function = staticmethod(pull_colours_back)
    run = staticmethod(_run_colours_back)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [variables[k].type() for k in (1, 1, 3, 4)])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        return [shapes[k] for k in (1, 1, 3, 4)]


class FactorisePartials(_Compiled):
    """Cholesky factor (p, p) from partials (pair,) (`covariance`)."""

    function = staticmethod(factorise_partials)
    run = staticmethod(_run_factor)

    def make_node(self, partial: Variable) -> Apply:
        """Build the node."""
        return Apply(self, [pt.as_tensor_variable(partial)], [pt.dmatrix()])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        size = pt.cast((1 + pt.sqrt(1 + 8 * shapes[0][0])) // 2, "int64")
        return [(size, size)]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the factor back."""
        return [PullFactorBack()(inputs[0], outputs[0], cotangents[0])]


class PullFactorBack(_Compiled):
    """The derivative of `FactorisePartials`."""

    function = staticmethod(pull_factor_back)
    run = staticmethod(_run_factor_back)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [variables[0].type()])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [shapes[0]]


def _compile(op: _Compiled, **_: object) -> tuple[Callable, int]:
    key = digest_function(type(op).run)  # PyTensor's own cache sees only names
    return numba_njit(type(op).run), int(key[:15], 16)


for _operation in (
    Multiply, ExpandedLikelihood, ShiftPull, ShiftPullBack, ColourTrials, PullColoursBack,
    FactorisePartials, PullFactorBack,
):  # fmt: skip
    register_funcify_default_op_cache_key(_operation)(_compile)
