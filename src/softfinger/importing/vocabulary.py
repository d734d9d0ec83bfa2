"""Words that laboratories use in column names."""

import re
from collections.abc import Iterable, Mapping
from functools import cache

from softfinger.campaign.units import find_factor, is_unit
from softfinger.faults import Fault

# Role → quantity → words, the most telling quantity first; of several languages.
CLOCK = {
    "time": "time zeit prüfzeit testzeit laufzeit temps tiempo tempo timestamp stamp t elapsed "
    "xvalue seconds secs sec millis micros "
    "uhrzeit date datetime datum 時間 时间 시간 tijd czas время ts",
    "frame": "frame frames frameid frameidx bild image img 帧 フレーム",
}
MOTION = {
    "angle": "angle angles theta winkel angolo kulma q th phi bend bending bendangle flexion "
    "rotation "
    "joint 角度 関節 kink orientation pitch yaw roll curl",
    "strain": "strain dehnung déformation deformation eps epsilon ε verformung stauchung "
    "kriechdehnung ひずみ 歪 应变",
    "displacement": "displacement displ disp d deflection extension elongation elong travel stroke "
    "crosshead indentation lvdt laser weg dehnweg standardweg traversenweg verschiebung traverse "
    "hub durchbiegung déplacement 変位 位移",
    "curvature": "curvature krümmung kappa courbure 曲率",
    "compliance": "compliance nachgiebigkeit",
    "position": "position pos height length distance gap x y z l abstand länge höhe tip",
    "sensor": "flex sensor encoder",
}
LOAD = {
    "tension": "tension zugkraft cable wire tendon 張力",
    "torque": "torque moment drehmoment couple effort トルク",
    "force": "force kraft prüfkraft standardkraft f load last weight gewicht 荷重 力 loadcell fz",
    "stress": "stress spannung contrainte sigma σ 応力 应力",
    "pressure": "pressure druck pression p 圧力 压力",
    "command": "pwm duty command cmd u input control signal ref",
    "voltage": "voltage volt v spannungsversorgung 電圧",
    "current": "current strom courant ampere 電流",
    "mass": "mass masse payload",
}
ENVIRONMENT = {
    "temperature": "temperature temp temperatur température 温度 tempc",
    "humidity": "humidity rh feuchte luftfeuchte humidité 湿度",
    "payload": "payload",
}
TRIAL = (
    "trial run test specimen sample experiment exp rep repetition cycle probe versuch session "
    "subject file finger essai 試験 step"
)
POINT = (
    "id tag marker point pointid markerid tagid keypoint label track bodypart node aruco apriltag "
    "dot feature target object"
)
JOINT = "joint link segment gelenk glied 関節 关节"
SIGNAL = "signal variable channel quantity name topic field sensor parameter kanal measurement"
VALUE = "value val wert reading data messwert"
# Words that make a column less likely to be what the rest of its name means.
DERIVED = (
    "setpoint target desired goal limit nominal max min maximum minimum failure ultimate std sd "
    "error err raw vel velocity rate speed acc accel acceleration gyro unconstrained derivative "
    "temp temperature status flag abs gt level degree filtered cell area reference predicted model"
)
APPLIED = "applied creep actual measured mean constant dead"
DIMENSIONS = {
    "time": "s", "angle": "rad", "strain": "1", "displacement": "m", "curvature": "1/m",
    "compliance": "1/Pa", "position": "m", "tension": "N", "torque": "N*m", "force": "N",
    "stress": "Pa", "pressure": "Pa", "voltage": "V", "current": "A", "mass": "kg",
    "temperature": "kelvin", "humidity": "1", "payload": "kg", "command": "1",
}  # fmt: skip
TOKEN = re.compile(r"[A-Z]+(?![a-zà-ÿ])|[A-Z]?[a-zà-ÿ]+|[Ͱ-Ͽ]+|[^\W\d_a-zA-Zà-ÿ]+|\d+")


def list_tokens(name: str) -> list[str]:
    """Words of a name, in lower case.

    >>> list_tokens("pwm_dutyLimb0 [%]"), list_tokens("AngularVel1"), list_tokens("Prüfzeit")
    (['pwm', 'duty', 'limb', '0'], ['angular', 'vel', '1'], ['prüfzeit'])
    """
    return [token.lower() for token in TOKEN.findall(name)]


def score_words(name: str, words: str) -> float:
    """How well a name fits: 2 whole, 1 part."""
    tokens = list_tokens(name)
    known = words.split()
    joined = "".join(tokens)
    if joined in known or any(token in known for token in tokens):
        return 2.0
    return float(any(len(word) > 3 and word in joined for word in known))


@cache
def list_foreign_words() -> tuple[str, ...]:
    """Words that are not in Latin letters."""
    words = " ".join(
        [*CLOCK.values(), *MOTION.values(), *LOAD.values(), *ENVIRONMENT.values(), TRIAL]
    )
    return tuple(word for word in words.split() if len(word) > 1 and ord(word[0]) > 0x2FFF)


def is_derived(name: str) -> bool:
    """Whether a name means a limit, rate or alike."""
    return score_words(name, DERIVED) == 2.0


def find_quantity(name: str, unit: str, role: Mapping[str, str]) -> tuple[str, float]:
    """Quantity of a role that a column fits best.

    It is judged by the column's name and unit. How well it fits is returned too.

    A unit that fits adds 1.5, a unit that does not takes 3 away; what is derived loses 1.5.

    >>> find_quantity("Standardkraft", "N", LOAD)[0], find_quantity("F", "N", LOAD)[0]
    ('force', 'force')
    >>> find_quantity("Creep Strain", "-", MOTION)[0]
    'strain'
    """
    best, found = -9.0, ""
    for place, (quantity, words) in enumerate(role.items()):
        score = score_words(name, words)
        fits = unit and quantity in DIMENSIONS and is_alike(unit, DIMENSIONS[quantity])
        if fits and unit in ("1", "-", "") and not score:
            fits = False
        score += 1.5 if fits else 0.0
        if unit and not fits and quantity in DIMENSIONS:
            score -= 3.0 * (not _is_counted(unit, quantity))
        if score > 0:
            score -= 0.01 * place
        if score > best:
            best, found = score, quantity
    best -= 1.5 * is_derived(name)
    if found == "position" and role is MOTION and find_quantity(name, unit, LOAD)[1] >= best:
        best = 0.0  # the z of a force is no place
    return found if best > 0 else "", best


def _is_counted(unit: str, quantity: str) -> bool:
    """Whether a unit of counts fits a quantity."""
    plain = not is_unit(unit) or is_alike(unit, "1") or is_alike(unit, "pixel")
    return plain and quantity not in ("time", "torque", "stress")


@cache
def is_alike(unit: str, other: str) -> bool:
    """Whether two units measure one thing.

    >>> is_alike("ms", "s"), is_alike("deg", "1")
    (True, False)
    """
    try:
        find_factor(unit, other)
    except Fault:
        return False
    if other in ("rad", "1"):  # pint takes angles and shares for one thing
        angle = (
            any(word in unit.lower() for word in ("rad", "deg", "°")) and "degc" not in unit.lower()
        )
        return angle == (other == "rad")
    return True


def pick(names: Iterable[str], words: str) -> list[str]:
    """Names that contain one of the words whole."""
    return [name for name in names if score_words(name, words) == 2.0]
