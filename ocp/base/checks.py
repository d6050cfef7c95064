"""Check the numbers that a user gives; a refusal names the value and the remedy."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")


def of_kind(name: str, value: object, kind: type[T], remedy: str) -> T:
    """A value of a class."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} is {reprlib.repr(value)}; give {remedy}")
    return value


def report_given(report: T) -> T:
    """What is called with the progress; ValueError where it cannot be called."""
    if not callable(report):
        raise ValueError(f"report is {reprlib.repr(report)}; give a function, or leave it out")
    return report


def listed(name: str, values: Any, remedy: str) -> list[Any]:
    """Several values as a list."""
    try:
        if isinstance(values, str | bytes | Mapping):
            raise TypeError
        one_by_one = iter(values)
    except TypeError:
        raise ValueError(f"{name} is {reprlib.repr(values)}; give {remedy}") from None
    return list(one_by_one)


def real_array(name: str, values: Any, remedy: str) -> NDArray[np.float64]:
    """Numbers as an array of any shape."""
    try:
        if values is None or np.iscomplexobj(values):
            raise TypeError  # NumPy takes None for nan, and drops an imaginary part
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} are {reprlib.repr(values)}; give {remedy}") from None


def finite(name: str, value: object, unit: str = "") -> float:
    """A finite number as a float: numpy's numbers count, booleans and text do not."""
    wanted = f"number in {unit}" if unit else "number"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{name} is {value!r}; give a {wanted}")
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value}; give a finite {wanted}")
    return number


def positive(name: str, value: object, unit: str = "") -> float:
    """A positive finite number as a float."""
    number = finite(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} is {f'{number:g} {unit}'.strip()}; give a positive number")
    return number


def not_negative(name: str, value: object, unit: str = "") -> float:
    """A finite number of 0 or more as a float."""
    number = finite(name, value, unit)
    if number < 0:
        raise ValueError(f"{name} is {f'{number:g} {unit}'.strip()}; give 0 or more")
    return number


def whole(name: str, value: object, least: int, most: int | None = None, because: str = "") -> int:
    """A whole number as an int."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise ValueError(f"{name} is {value!r}; give a whole number from {least} up")
    number = int(value)
    if most is not None and number > most:
        raise ValueError(f"{name} is {number}; give at most {most}{because and f': {because}'}")
    return number
