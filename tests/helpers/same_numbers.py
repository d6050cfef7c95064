"""Compare what two executions print: the words exactly, the numbers within their last digit."""

import re

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?%?")
NOTHING = 1e-5
"""Below this a residual at rest is what an integrator leaves, in any unit that is printed."""


def differences(committed, anew):
    """List what is printed differently, as pairs; none if all is as it was."""
    if _words(committed) != _words(anew):
        return [(committed, anew)]
    pairs = zip(NUMBER.findall(committed), NUMBER.findall(anew), strict=True)
    return [(one, other) for one, other in pairs if not _same(one, other)]


def _words(text):
    """The text with a mark for each number, whatever the width of its column."""
    return NUMBER.sub("#", text).split()


def _same(one, other):
    """Whole numbers are counts and equal; others agree in all digits but the last, or to 0.1 %."""
    a, b = (float(text.rstrip("%")) for text in (one, other))
    if re.fullmatch(r"[-+]?\d+", one):
        return a == b
    if max(abs(a), abs(b)) < NOTHING:
        return True
    return abs(a - b) <= max(1.01 * _last_digit(one), 1e-3 * abs(a))


def _last_digit(text):
    digits, _, exponent = text.rstrip("%").lower().partition("e")
    decimals = len(digits.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals)
