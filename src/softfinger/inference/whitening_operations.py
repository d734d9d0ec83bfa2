"""Operations of the whitening that PyMC lacks."""

from collections.abc import Sequence

import numpy as np
import pytensor.tensor as pt
from numpy.typing import NDArray
from pytensor.gradient import DisconnectedType
from pytensor.graph.basic import Apply, Variable

from softfinger.compiled import compiled
from softfinger.inference.operation import CompiledOperation, own
from softfinger.inference.whitening import colour_trials, pull_colours_back, shift_pull


def _run_shift(pull: NDArray, cross: NDArray, change: NDArray):  # noqa: ANN202
    return shift_pull(own(pull), own(cross), own(change))


class ShiftPull(CompiledOperation):
    """Pull of the stand-in after effects changed (`whitening`).

    Inputs: pull (d, trial), cross (d, p, trial), change φ − φ* (p,). Output: pull (d, trial).
    """

    function = staticmethod(compiled(_run_shift))
    run = staticmethod(_run_shift)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """As the first input."""
        return [inputs[0].type()]

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


def _run_shift_back(cross: NDArray, pull_bar: NDArray):  # noqa: ANN202
    back = np.zeros(cross.shape[1])
    for a in range(cross.shape[0]):
        for k in range(back.size):
            back[k] -= (cross[a, k] * pull_bar[a]).sum()
    return back


class ShiftPullBack(CompiledOperation):
    """The derivative of `ShiftPull` by the change."""

    function = staticmethod(compiled(_run_shift_back))
    run = staticmethod(_run_shift_back)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """A vector."""
        return [pt.dvector()]

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shape of the output."""
        return [(shapes[0][1],)]


def _run_colours(  # noqa: ANN202
    z: NDArray, curvature: NDArray, pull: NDArray, mean: NDArray, precision: NDArray
):
    return colour_trials(own(z), own(curvature), own(pull), own(mean), own(precision))


class ColourTrials(CompiledOperation):
    """The trials' parameters from standard normals (`whitening`).

    Inputs: z (p, trial), curvature, pull, mean (p,), precision (p, p). Outputs: eta (p, trial),
    log_volume (trial,), and the Cholesky factors for the way back.
    """

    function = staticmethod(colour_trials)
    run = staticmethod(_run_colours)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """As z; a number for each trial; its factor."""
        kind = inputs[0].type
        volume = pt.TensorType("float64", kind.shape[1:])()
        return [kind(), volume, pt.TensorType("float64", (kind.shape[0], *kind.shape))()]

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


def _run_colours_back(  # noqa: ANN202
    eta: NDArray, z: NDArray, factor: NDArray, mean: NDArray, precision: NDArray, eta_bar: NDArray,
    volume_bar: NDArray,
):  # fmt: skip
    return pull_colours_back(
        own(eta), own(z), own(factor), own(mean), own(precision), own(eta_bar), own(volume_bar)
    )


class PullColoursBack(CompiledOperation):
    """The derivative of `ColourTrials`."""

    function = staticmethod(pull_colours_back)
    run = staticmethod(_run_colours_back)

    def type_outputs(self, *inputs: Variable) -> list[Variable]:
        """As the inputs that are not data."""
        return [inputs[k].type() for k in (1, 1, 3, 4)]

    def infer_shape(self, node: Apply, shapes: Sequence) -> list:
        """Shapes of the outputs."""
        return [shapes[k] for k in (1, 1, 3, 4)]
