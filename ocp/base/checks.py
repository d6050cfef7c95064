"""Check the numbers that a user gives; a refusal names the value and the remedy."""

from __future__ import annotations

import math
import operator
from typing import Any


def finite(name: str, value: Any, unit: str = "") -> float:
    """A finite number as a float."""
    wanted = f"number in {unit}" if unit else "number"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; give a {wanted}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value}; give a finite {wanted}")
    return number


def positive(name: str, value: Any, unit: str = "") -> float:
    """A positive finite number as a float."""
    number = finite(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} is {f'{number:g} {unit}'.strip()}; give a positive number")
    return number


def not_negative(name: str, value: Any, unit: str = "") -> float:
    """A finite number of 0 or more as a float."""
    number = finite(name, value, unit)
    if number < 0:
        raise ValueError(f"{name} is {f'{number:g} {unit}'.strip()}; give 0 or more")
    return number


def whole(name: str, value: Any, least: int, most: int | None = None, because: str = "") -> int:
    """A whole number as an int."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if number < least:
        raise ValueError(f"{name} is {value!r}; give a whole number from {least} up")
    if most is not None and number > most:
        raise ValueError(f"{name} is {number}; give at most {most}{because and f': {because}'}")
    return number
