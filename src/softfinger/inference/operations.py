"""Operations of the density that PyMC lacks."""

from collections.abc import Sequence

import numpy as np
import pytensor.tensor as pt
from numpy.typing import NDArray
from pytensor.gradient import DisconnectedType
from pytensor.graph.basic import Apply, Variable

from softfinger.compiled import compiled
from softfinger.inference.expansion import slope_squares
from softfinger.inference.operation import CompiledOperation, own
from softfinger.measurement.covariance import factorise_partials, pull_factor_back


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


class ExpandedLikelihood(CompiledOperation):
    """Log likelihood summed over trials (`expansion`).

    Σ log p(y | η, φ, s), without constants.

    Inputs: eta (d, trial), effect (p,), log of the noise's scale (); then the expansion's own,
    shared, gram, rows. Outputs: the sum and, for its derivatives, its slopes by the first three.
    """

    function = staticmethod(evaluate_likelihood)
    run = staticmethod(_run_likelihood)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """The sum; slopes have their parameters' types."""
        return [pt.dscalar(), *(x.type() for x in inputs[:3])]

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


def _run_product(a: NDArray, b: NDArray) -> NDArray:
    product = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            product[i] += a[i, k] * b[k]
    return product


class Multiply(CompiledOperation):
    """Product of two matrices; PyTensor's own compiles slowly."""

    function = staticmethod(compiled(_run_product))
    run = staticmethod(_run_product)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """A matrix."""
        return [pt.dmatrix()]

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [(shapes[0][0], shapes[1][1])]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the product back."""
        a, b = inputs
        return [Multiply()(cotangents[0], b.T), Multiply()(a.T, cotangents[0])]


def _run_factor(partial: NDArray):  # noqa: ANN202
    return factorise_partials(own(partial))


def _run_factor_back(partial: NDArray, factor: NDArray, factor_bar: NDArray):  # noqa: ANN202
    return pull_factor_back(own(partial), own(factor), own(factor_bar))


class FactorisePartials(CompiledOperation):
    """Cholesky factor (p, p) from partials (pair,) (`covariance`)."""

    function = staticmethod(factorise_partials)
    run = staticmethod(_run_factor)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """A matrix."""
        return [pt.dmatrix()]

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        size = pt.cast((1 + pt.sqrt(1 + 8 * shapes[0][0])) // 2, "int64")
        return [(size, size)]

    def pullback(
        self, inputs: Sequence[Variable], outputs: Sequence[Variable], cotangents: Sequence
    ) -> list[Variable]:
        """Pull the cotangent of the factor back."""
        return [PullFactorBack()(inputs[0], outputs[0], cotangents[0])]


class PullFactorBack(CompiledOperation):
    """The derivative of `FactorisePartials`."""

    function = staticmethod(pull_factor_back)
    run = staticmethod(_run_factor_back)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """As the first input."""
        return [inputs[0].type()]

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [shapes[0]]
