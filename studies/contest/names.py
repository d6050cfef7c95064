"""What methods are called in a contest, in its files and in what it shows."""

from __future__ import annotations

import re

from metaheuristics.budget.run import MULTISTART, Help, parts_of
from studies.registry.methods import method_of

_HELPED = {Help.NONE: "", Help.POLISH: ", then polished", Help.SEEDS: " from gradient seeds"}
_GIVEN = re.compile(r"\w[\w .,+/()=-]{0,59}")


def is_own(name: str) -> bool:
    """Whether it is the name of a method that is run here, not of one whose results came."""
    try:
        parts_of(name)
    except ValueError:
        return False
    return True


def label_of(name: str) -> str:
    """What a method is called in tables and pictures."""
    if not is_own(name):
        return name
    search, helped = parts_of(name)
    label = "gradient, random starts" if search == MULTISTART else method_of(search).label
    return f"{label}{_HELPED[helped]}"


def name_given(text: str) -> str:
    """A name for a method whose results come from elsewhere.

    Raises
    ------
    ValueError
        When it is the name of a method of quietarm's own, or is none for a folder.
    """
    name = text.strip()
    if not _GIVEN.fullmatch(name):
        raise ValueError(
            f"the name {name!r} does not do for a method; give up to 60 letters, digits, spaces "
            "and . , + / ( ) = - with a letter or digit first"
        )
    if is_own(name):
        raise ValueError(
            f"{name!r} is a method that is run here; name what others found differently, as "
            f"{name + ' of mine'!r}"
        )
    return name


def folder_of(name: str) -> str:
    """The name of a method's folder."""
    return name.replace("/", "_")
