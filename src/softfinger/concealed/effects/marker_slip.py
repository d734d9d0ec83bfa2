"""A link's markers slip in every other trial."""

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect
from softfinger.concealed.rig import Rig


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    """Turn the link by the strength [rad].

    It only seems to turn: its own joint gains what the next one loses.
    """
    slipped = angle.copy()
    if trial.luck[0] < 0.5 or trial.count == 1:
        late = time >= (0.2 + 0.6 * trial.luck[1]) * trial.duration
        link = dose.joints[0]
        slipped[late, link] += dose.strength
        if link + 1 < angle.shape[1]:
            slipped[late, link + 1] -= dose.strength
    return slipped


EFFECT = Effect(
    id="marker_slip",
    sentence="markers that slip on their link at one moment of a trial",
    level="measurement",
    joints="one",
    typical=0.015,
    largest=0.08,
    record=_record,
)
