"""An elastic skin over two neighbouring joints."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Add a torque s δ to both joints.

    s [N m/rad] acts on a pair; δ is the other's deflection, and saturates.
    """
    first, second = dose.joints
    coupling = physics.coupling.copy()
    coupling[first, second] += dose.strength * (1.0 if dose.shape["helping"] else -1.0)
    coupling[second, first] = coupling[first, second]
    return physics._replace(coupling=coupling)


EFFECT = Effect(
    id="joint_coupling",
    sentence="one joint's deflection that feeds its neighbour's",
    level="within_trial",
    joints="pair",
    typical=0.008,
    largest=0.03,
    shape={"helping": Shape(0.0, 1.0, choice=True)},
    move=_move,
)
