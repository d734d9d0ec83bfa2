"""Numbers with no more digits than certain."""

import math

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

LEAST_SHARE_SHOWN = 20.0
"""How many times wider than its value a standard deviation may be before the value reads 0."""


def format_measure(value: float, sd: float) -> str:
    """A value with its standard deviation, rounded.

    The rule is the Particle Data Group's.

    >>> format_measure(0.08712, 0.00213), format_measure(48431.0, 5120.0)
    ('0.0871 ± 0.0021', '(4.8 ± 0.5) × 10⁴')
    >>> format_measure(3.2, float("nan")), format_measure(float("nan"), 1.0)
    ('3.2', '–')

    The median of something positive keeps a digit, however wide it is:

    >>> format_measure(0.41, 5.1)
    '0.4 ± 5.1'
    """
    if not math.isfinite(value):
        return "–"
    if not math.isfinite(sd) or sd <= 1e-6 * abs(value):
        return format_number(value, 6)
    exponent = choose_exponent(value if abs(value) > sd else sd)
    decimals = count_decimals(sd / 10**exponent)
    if sd / LEAST_SHARE_SHOWN < abs(value) < sd:
        decimals = max(decimals, count_decimals(abs(value) / 10**exponent))
    body = f"{fix(value / 10**exponent, decimals)} ± {fix(sd / 10**exponent, decimals)}"
    return f"({body}) × 10{str(exponent).translate(SUPERSCRIPTS)}" if exponent else body


def count_decimals(sd: float) -> int:
    """Decimals that a standard deviation leaves.

    It keeps two digits up to 3.54, then one.

    >>> count_decimals(0.0123), count_decimals(0.0082), count_decimals(0.00967)
    (3, 3, 3)
    """
    exponent = math.floor(math.log10(sd))
    lead = sd / 10**exponent
    digits = 2 if lead < 3.55 else 1
    return max(0, digits - 1 - exponent)


def format_interval(low: float, high: float) -> str:
    """An interval, rounded by its width.

    It shows two digits of a quarter of its width, which is about its standard deviation.

    >>> format_interval(0.08312, 0.09123), format_interval(41230.0, 57000.0)
    ('0.0831 to 0.0912', '(4.12 to 5.70) × 10⁴')
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        return "–"
    width = (high - low) / 4 or abs(high) or 1.0
    exponent = choose_exponent(max(abs(low), abs(high)))
    decimals = max(0, 1 - math.floor(math.log10(width / 10**exponent)))
    body = f"{fix(low / 10**exponent, decimals)} to {fix(high / 10**exponent, decimals)}"
    return f"({body}) × 10{str(exponent).translate(SUPERSCRIPTS)}" if exponent else body


def format_number(value: float, digits: int = 3) -> str:
    """A number with so many significant digits.

    It has no needless exponent.

    >>> format_number(0.0123456), format_number(1234567.0), format_number(float("inf"))
    ('0.0123', '1.23 × 10⁶', '∞')
    >>> format_number(1815.2)
    '1820'
    """
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    exponent = choose_exponent(value)
    text = f"{value / 10**exponent:.{digits}g}"
    if "e+" in text:
        text = f"{float(text):.0f}"
    text = text.replace("-", "−")
    return f"{text} × 10{str(exponent).translate(SUPERSCRIPTS)}" if exponent else text


def format_percent(share: float, decimals: int = 0) -> str:
    """Write a share as percent.

    >>> format_percent(0.947), format_percent(0.947, 1)
    ('95 %', '94.7 %')
    """
    return "–" if not math.isfinite(share) else f"{fix(100 * share, decimals)} %"


def format_shares(low: float, high: float, decimals: int = 0) -> str:
    """Write an interval of shares as percent.

    >>> format_shares(0.05, 0.125, 1), format_shares(float("nan"), float("nan"))
    ('5.0 % to 12.5 %', '–')
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        return "–"
    return f"{format_percent(low, decimals)} to {format_percent(high, decimals)}"


def fix(value: float, decimals: int) -> str:
    """A number with fixed decimals, true minus sign.

    Zero has no minus.
    """
    text = f"{value:.{decimals}f}"
    negative = text.startswith("-") and float(text) != 0
    return ("−" if negative else "") + text.lstrip("-")


def choose_exponent(value: float) -> int:
    """Power of ten to write apart.

    It is 0 from 0.001 to 10000.

    >>> choose_exponent(0.02), choose_exponent(48000.0), choose_exponent(0.0)
    (0, 4, 0)
    """
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return 0
    return math.floor(math.log10(abs(value)))


def join_words(words: list[str]) -> str:
    """Join words as prose.

    >>> join_words(["1", "2", "3"])
    '1, 2 and 3'
    """
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def shorten_list(sentences: list[str], most: int, where: str) -> list[str]:
    """Keep the first sentences, and point to where the others are.

    >>> shorten_list(["One.", "Two.", "Three."], 1, "the table")
    ['One.', '2 more: see the table.']
    """
    hidden = len(sentences) - most
    return sentences if hidden <= 0 else [*sentences[:most], f"{hidden} more: see {where}."]


def count_things(number: int, thing: str) -> str:
    """Count with the right plural.

    >>> count_things(1, "trial"), count_things(1200, "frame")
    ('1 trial', '1200 frames')
    """
    return f"{number} {thing}{'' if number == 1 else 's'}"


def capital(sentence: str) -> str:
    """Raise the first letter.

    >>> capital("rule fit")
    'Rule fit'
    """
    return sentence[:1].upper() + sentence[1:]
