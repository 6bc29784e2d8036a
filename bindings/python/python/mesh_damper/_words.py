"""Numbers as text, with a suitable number of digits."""

from __future__ import annotations

import math


def percent(part: float) -> str:
    """Write a fraction as a percentage with three digits."""
    return f"{number(100.0 * part)} %"


def number(value: float) -> str:
    """Write three significant digits, with an exponent only for a very large or very small number."""
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "∞" if value > 0 else "−∞"
    magnitude = math.floor(math.log10(abs(value)))
    text = f"{value:.2e}" if not -4 <= magnitude < 6 else f"{value:.{max(0, 2 - magnitude)}f}"
    return text.replace("-", "−")


def interval(low: float | None, value: float, high: float | None) -> tuple[str, str, str]:
    """Write ends and value of an interval with enough decimals to distinguish them; an end without a bound is infinite."""
    if low is None or high is None or not high > low:
        return number(-math.inf if low is None else low), number(value), number(math.inf if high is None else high)
    decimals = 1 - math.floor(math.log10(high - low))
    largest = max(abs(low), abs(high))
    if not 0 <= decimals <= 9 or not 1e-4 <= largest < 1e6:
        return number(low), number(value), number(high)
    written = [f"{each:.{decimals}f}".replace("-", "−") for each in (low, value, high)]
    return written[0], written[1], written[2]


def unit_in_words(unit: str) -> str:
    """Write a unit in typographic form: kN·s/mm, kN/mm³."""
    if unit == "1":
        return ""
    written, raised = "", False
    for character in unit.replace("*", "·").replace("degC", "°C"):
        if character == "^":
            raised = True
        elif raised and character in _RAISED:
            written += _RAISED[character]
        else:
            raised = False
            written += character
    return written


_RAISED = dict(zip("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
