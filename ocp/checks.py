"""Check the numbers and names that a user gives; a refusal names value and remedy."""

from __future__ import annotations

import difflib
import math
import operator
import re
from collections.abc import Collection
from typing import Annotated, Any, TypeVar

from msgspec import Meta

T = TypeVar("T")


def finite(name: str, value: Any, unit: str = "", most: float = math.inf, why: str = "") -> float:
    """A finite number as a float."""
    wanted = f"number in {unit}" if unit else "number"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; give a {wanted}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value}; give a finite {wanted}")
    if abs(number) > most:
        raise ValueError(f"{name} is {number:g}; give at most {most:g}{why and f' ({why})'}")
    return number


def positive(name: str, value: Any, unit: str = "", most: float = math.inf, why: str = "") -> float:
    """A positive finite number as a float."""
    number = finite(name, value, unit, most, why)
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


_ALIKE = 0.55
"""Share of letters in common from which on a name is asked for."""
_PART = 3
"""So many letters of a longer name are enough."""


def unknown(what: str, name: str, known: Collection[str], also: str = "") -> str:
    """The message about a name that is not known."""
    return f"unknown {what} {name!r}{nearest(name, known)} (known: {', '.join(known)}{also})"


def has_no(owner: str, what: str, name: str, known: Collection[str]) -> str:
    """The message about a name that something does not have."""
    listed = ", ".join(known) or "none"
    return f"{owner} has no {what} {name!r}{nearest(name, known)} (it has: {listed})"


def nearest(name: str, known: Collection[str]) -> str:
    """A question for a message, with the known name that is most like an unknown one."""
    same = [other for other in known if spelling(other) == spelling(name)]
    part = [other for other in known if len(name) >= _PART and name.lower() in other.lower()]
    near = same or part or difflib.get_close_matches(name.lower(), list(known), n=1, cutoff=_ALIKE)
    return f"; did you mean {near[0]!r}?" if near else ""


def spelling(name: str) -> str:
    """A name without what people spell differently: NSGA-II and nsga_2 are nsga2."""
    small = re.sub(r"[-_ ]", "", name.lower())
    return re.sub(r"i{2,3}$", lambda match: str(len(match[0])), small)


def cut(text: str, most: int) -> str:
    """A text of at most so many letters, without its middle where it is longer."""
    if len(text) <= most:
        return text
    left = (most - 5) // 2
    return f"{text[:left]} ... {text[-left:]}"


def printable(text: str) -> str:
    """A text for a terminal, which would obey the control characters of a stranger's file."""
    if text.isprintable():
        return text
    kept = "\n\t\N{NO-BREAK SPACE}"
    return "".join(letter if letter.isprintable() or letter in kept else "?" for letter in text)


def known(family: type[T]) -> dict[str, type[T]]:
    """The subclasses that have a name of their own, by it, those of the user's own files too."""
    found: dict[str, type[T]] = {}
    for kind in family.__subclasses__():
        name = vars(kind).get("name")
        found |= ({name: kind} if isinstance(name, str) else {}) | known(kind)
    return found


def install(extra: str) -> str:
    """How to install what an extra of this project holds."""
    return f"install it: pip install 'quietarm[{extra}]', or '.[{extra}]' in a clone"


NotNegative = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
Share = Annotated[float, Meta(ge=0, le=1)]
Count = Annotated[int, Meta(ge=0)]
CountFromOne = Annotated[int, Meta(ge=1)]
