"""What a method may be set to: names, defaults, and checks of what a user gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from quietarm.ocp.checks import finite, has_no, nearest, positive, whole

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


def share(name: str, value: object) -> float:
    """A number from 0 to 1."""
    number = finite(name, value)
    if not 0 <= number <= 1:
        raise ValueError(f"{name} is {number:g}; give a number from 0 to 1")
    return number


def index_of_spread(name: str, value: object) -> float:
    """The index eta of a crossover or a mutation: pymoo allows 1 to 100, both left out."""
    number = finite(name, value)
    if not 1 < number < 100:
        raise ValueError(f"{name} is {number:g}; give a number between 1 and 100")
    return number


def positive_share(name: str, value: object) -> float:
    """A number above 0, up to 1."""
    number = share(name, value)
    return positive(name, number)


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
            raise ValueError(f"{name} is {value!r}; {hint}give one of {', '.join(choices)}")
        return str(value)

    return check


def count(least: int, most: int = MOST_KEPT) -> Callable[[str, object], int]:
    """A check for a whole number."""
    return lambda name, value: whole(name, value, least, most)


def scale(name: str, value: object) -> float:
    """The factor of a difference in differential evolution: above 0, at most 2."""
    number = positive(name, value)
    if number > 2:
        raise ValueError(f"{name} is {number:g}; give a number up to 2")
    return number


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
