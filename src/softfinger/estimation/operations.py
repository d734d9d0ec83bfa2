"""Operations that PyMC lacks, compiled by numba: the collapsed likelihood and the whitening.

They are ordinary PyTensor operations with exact derivatives, so any PyMC sampler can use them.
"""

from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytensor.tensor as pt
from numba import njit
from numpy.typing import NDArray
from pytensor.gradient import DisconnectedType
from pytensor.graph.basic import Apply, Variable
from pytensor.graph.op import Op
from pytensor.link.numba.dispatch.basic import (
    numba_njit,
    register_funcify_default_op_cache_key,
)

from softfinger.population import (
    basis,
    covariance,
    likelihood,
    weights,
    whitening,
    windows,
)
from softfinger.population.covariance import (
    factorise_partials,
    pull_factor_back,
    pull_partials_back,
)
from softfinger.population.likelihood import sum_log_likelihood
from softfinger.population.whitening import colour_trials, pull_colours_back
from softfinger.population.windows import Windows

own = np.ascontiguousarray  # linear algebra wants whole rows


# Not in numba's own cache, blind to other modules; inlined, as every layer is compiled whole again.
@njit(error_model="numpy", inline="always")
def evaluate_likelihood(
    eta: NDArray,
    sd: NDArray,
    rho: NDArray,
    partial: NDArray,
    place: NDArray,
    begin: NDArray,
    modes: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    window: NDArray,
    products: NDArray,
    first: NDArray,
    pattern: NDArray,
    patterns: NDArray,
    gap: NDArray,
    total: NDArray,
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """Sum log p over trials but for constants; also its slopes by η, σ, ρ and the partials."""
    factor = factorise_partials(partial)
    value, eta_bar, sd_bar, rho_bar, correlation_bar = sum_log_likelihood(
        eta, sd, rho, factor @ factor.T, Windows(place, begin, modes, table_value, table_slope),
        window, products, first, pattern, patterns, gap, total,
    )  # fmt: skip
    partial_bar = pull_partials_back(partial, factor, correlation_bar)
    return np.asarray(value), eta_bar, sd_bar, rho_bar, partial_bar


def _run_likelihood(  # noqa: ANN202
    eta: NDArray, sd: NDArray, rho: NDArray, partial: NDArray, place: NDArray, begin: NDArray,
    modes: NDArray, table_value: NDArray, table_slope: NDArray, window: NDArray, products: NDArray,
    first: NDArray, pattern: NDArray, patterns: NDArray, gap: NDArray, total: NDArray,
):  # fmt: skip
    return evaluate_likelihood(
        own(eta), own(sd), own(rho), own(partial), own(place), own(begin), own(modes),
        own(table_value), own(table_slope), own(window), own(products), own(first), own(pattern),
        own(patterns), own(gap), own(total),
    )  # fmt: skip


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
    """Product of two matrices. PyTensor's own is slow to compile, at every place anew."""

    function = staticmethod(njit(_run_product))
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


class CollapsedLikelihood(_Compiled):
    """Σ over trials of log p(y | η, noise), but for constants (`population.likelihood`).

    Inputs: eta (trial, joint, 4), noise sd, autocorrelation (joint,), partial correlations (pair,);
    then the data, in the order of `evaluate_likelihood`. Outputs: the sum and, for its
    derivatives, its slopes by the first four inputs.
    """

    function = staticmethod(evaluate_likelihood)
    run = staticmethod(_run_likelihood)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node; the slopes have the types of what they are slopes by."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [pt.dscalar(), *(x.type() for x in variables[:4])])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        return [(), *shapes[:4]]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the sum back."""
        slopes = [cotangents[0] * slope for slope in outputs[1:]]
        return slopes + [DisconnectedType()() for _ in inputs[4:]]

    def connection_pattern(self, node: Apply) -> list[list[bool]]:
        """Only the sum hangs on the parameters."""
        return [[k < 4, False, False, False, False] for k in range(len(node.inputs))]


class ColourTrials(_Compiled):
    """Parameters of the trials from standard normals, given the population (`whitening`).

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
        z_bar, mean_bar, precision_bar = PullColoursBack()(eta, z, factor, mean, precision, *bars)
        return [z_bar, DisconnectedType()(), DisconnectedType()(), mean_bar, precision_bar]

    def connection_pattern(self, node: Apply) -> list[list[bool]]:
        """Curvature and pull are data; the factor serves the way back only."""
        return [[k in (0, 3, 4)] * 2 + [False] for k in range(5)]


class PullColoursBack(_Compiled):
    """The derivative of `ColourTrials`."""

    function = staticmethod(pull_colours_back)
    run = staticmethod(_run_colours_back)

    def make_node(self, *inputs: Variable) -> Apply:
        """Build the node."""
        variables = [pt.as_tensor_variable(x) for x in inputs]
        return Apply(self, variables, [variables[k].type() for k in (1, 3, 4)])

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        return [shapes[k] for k in (1, 3, 4)]


class FactorisePartials(_Compiled):
    """Cholesky factor (p, p) of a correlation matrix from its partials (pair,) (`covariance`)."""

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


@cache
def _hash_sources() -> int:
    """Hash the code that the operations run, for PyTensor's cache sees only their names."""
    modules = (basis, covariance, likelihood, weights, whitening, windows)
    files = [Path(__file__), *(Path(module.__file__) for module in modules)]
    digest = sha256(b"".join(path.read_bytes() for path in files)).hexdigest()
    return int(digest[:15], 16)


def _compile(op: _Compiled, **_: object) -> tuple[Callable, int]:
    return numba_njit(type(op).run), _hash_sources()


for _operation in (
    Multiply, CollapsedLikelihood, ColourTrials, PullColoursBack, FactorisePartials, PullFactorBack
):  # fmt: skip
    register_funcify_default_op_cache_key(_operation)(_compile)
