"""What methods are called in a contest, in its files and in what it shows."""

from __future__ import annotations

import re
from collections.abc import Mapping

from quietarm.metaheuristics.algorithms.settings import Value
from quietarm.metaheuristics.budget.run import MULTISTART, Help, parts_of
from quietarm.studies.registry.methods import method_of

POPULATION = "population"
"""What may be set beside a method's own settings."""
_HELPED = {Help.NONE: "", Help.POLISH: ", then polished", Help.SEEDS: " from gradient seeds"}
_GIVEN = re.compile(r"\w[\w .,+/()=-]{0,59}")


def name_of(method: str, settings: Mapping[str, Value]) -> str:
    """What a method is called that is set to something: ``nsga2(crossover=0.7)``."""
    stated = ", ".join(f"{name}={_plain(value)}" for name, value in sorted(settings.items()))
    return f"{method}({stated})" if stated else method


def _plain(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.12g}" if isinstance(value, float) else str(value)


def method_in(name: str) -> str:
    """The method alone, without what it is set to."""
    return name.partition("(")[0]


def is_own(name: str) -> bool:
    """Whether it is the name of a method that is run here, not of one whose results came."""
    try:
        parts_of(method_in(name))
    except ValueError:
        return False
    return True


def label_of(name: str) -> str:
    """What a method is called in tables and pictures."""
    if not is_own(name):
        return name
    method = method_in(name)
    search, helped = parts_of(method)
    label = "gradient, random starts" if search == MULTISTART else method_of(search).label
    return f"{label}{_HELPED[helped]} {name.removeprefix(method)}".strip()


def name_given(name: str) -> str:
    """A name for a method whose results come from elsewhere."""
    if not _GIVEN.fullmatch(name):
        raise ValueError(
            f"the name {name!r} does not do for a method; give up to 60 letters, digits, spaces "
            "and . , + / ( ) = - with a letter or digit first"
        )
    if is_own(name):
        raise ValueError(f"{name!r} is a method that is run here; give another name")
    return name


def folder_of(name: str) -> str:
    """The name of a method's folder."""
    return name.replace("/", "_")
