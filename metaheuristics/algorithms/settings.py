"""What a method may be set to: names, defaults, and checks of what a user gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from quietarm.ocp.checks import finite, has_no, nearest, whole

Value = float | int | bool | str | None
MOST_KEPT = 100_000
"""Most points in an archive."""


@dataclass(frozen=True)
class Setting:
    """A setting of a method."""

    name: str
    argument: str
    default: Value
    meaning: str
    check: Callable[[str, Any], Value]


def _number(wanted: str, fits: Callable[[float], bool]) -> Callable[[str, object], float]:
    def check(name: str, value: object) -> float:
        number = finite(name, value)
        if not fits(number):
            raise ValueError(f"{name} is {number:g}; give {wanted}")
        return number

    return check


share = _number("a number from 0 to 1", lambda number: 0 <= number <= 1)
positive_share = _number("a positive number up to 1", lambda number: 0 < number <= 1)
scale = _number("a positive number up to 2", lambda number: 0 < number <= 2)
index_of_spread = _number("a number between 1 and 100", lambda number: 1 < number < 100)
"""Of a crossover or a mutation: pymoo allows 1 to 100, both left out."""


def yes_or_no(name: str, value: object) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise ValueError(f"{name} is {value!r}; give true or false")
    return value


def one_of(*choices: str) -> Callable[[str, object], str]:
    """A check for one of several words."""

    def check(name: str, value: object) -> str:
        if value not in choices:
            hint = nearest(str(value), choices)
            raise ValueError(f"{name} is {value!r}; give one of {', '.join(choices)}{hint}")
        return str(value)

    return check


def count(least: int, most: int = MOST_KEPT) -> Callable[[str, object], int]:
    """A check for a whole number."""
    return lambda name, value: whole(name, value, least, most)


def with_defaults(
    method: str, known: Iterable[Setting], given: Mapping[str, object] | None
) -> dict[str, Value]:
    """All settings of a method: those that are given, each checked, and the defaults."""
    entries = {setting.name: setting for setting in known}
    given = {} if given is None else given
    for name in given:
        if name not in entries:
            raise ValueError(has_no(method, "setting", str(name), entries))
    return {
        name: setting.check(name, given[name]) if name in given else setting.default
        for name, setting in entries.items()
    }
