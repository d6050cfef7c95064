"""Check the numbers and names that a user gives; a refusal names value and remedy."""

from __future__ import annotations

import difflib
import math
import operator
import re
import reprlib
from collections.abc import Collection, Iterable
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ALIKE = 0.55
"""Share of letters in common from which on a name is asked for."""
_PART = 3
"""So many letters of a longer name are enough."""
MOST_QUOTED = 80
"""Letters of a file that a message quotes: the file may be a stranger's, or a secret."""
_MOST_LISTED = 600
"""Letters of a list of names: some thirty of a robot's joints."""
_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 4 * MOST_QUOTED


def cut(text: str, most: int) -> str:
    """A text of at most so many letters, without its middle where it is longer."""
    if len(text) <= most:
        return text
    head = (most - 5) // 2
    return f"{text[:head]} ... {text[-head:]}"


def quoted(value: object, most: int = MOST_QUOTED) -> str:
    """A value of a file as a message quotes it, without its middle where it is long."""
    return cut(" ".join(_SHORT.repr(value).split()), most)


def clipped(text: str, most: int = MOST_QUOTED) -> str:
    """The words of a parser, which may quote all of a file, in one line and without the middle."""
    return cut(" ".join(text.split()), most)


def finite(name: str, value: Any, unit: str = "", most: float = math.inf, why: str = "") -> float:
    """A finite number as a float; text and truth values are none."""
    wanted = f"number in {unit}" if unit else "number"
    try:
        number = float(_single_number(value))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} is {quoted(value)}; give a {wanted}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value}; give a finite {wanted}")
    if abs(number) > most:
        largest = _with_unit(most, unit)
        raise ValueError(
            f"{name} is {_with_unit(number, unit)}; give at most {largest}{why and f' ({why})'}"
        )
    return number


def _with_unit(number: float, unit: str) -> str:
    return f"{number:g} {unit}".strip()


def _no_truth_value(value: Any) -> Any:
    """The value; TypeError for True and False, which count as 1 and 0 in Python."""
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b":
        raise TypeError(f"{quoted(value)} is no number")
    return value


def _single_number(value: Any) -> Any:
    """The value; TypeError for text and what is masked, of which a number is made as well."""
    if isinstance(value, str | bytes) or _is_masked(_no_truth_value(value)):
        raise TypeError(f"{quoted(value)} is no number")
    return value


def _is_masked(value: Any) -> bool:
    return hasattr(value, "filled")  # to name numpy's class would load numpy.ma


def numbers(name: str, value: Any, wanted: str, *, infinite: bool = False) -> Array:
    """Numbers as an array of floats, of any shape; ValueError that says what is wanted.

    Text, truth values, complex numbers, dates, ragged and masked arrays, sets and generators are
    none; nor is what is infinite or no number, unless that is allowed.
    """
    try:
        if _is_masked(value):
            raise TypeError
        table = np.asarray(value)
        if table.dtype.kind not in "iufO":
            raise TypeError
        if table.dtype.kind == "O":
            table = np.reshape([_real(entry) for entry in table.flat], table.shape)
        table = table.astype(float)
    except Exception:  # an object's own __array__ may raise anything
        raise ValueError(f"{name} {_is(name)} {quoted(value)}; give {wanted}") from None
    if not infinite and not np.isfinite(table).all():
        raise ValueError(f"{name} {_is(name)} {quoted(value)}; give {wanted}, all of them finite")
    return table


def _real(entry: Any) -> float:
    if not isinstance(entry, Real) or isinstance(entry, bool):
        raise TypeError(f"{entry!r} is no number")
    return float(entry)


def _is(name: str) -> str:
    """The verb of a name, which is of one or of several."""
    return "are" if name.endswith("s") else "is"


def positive(name: str, value: Any, unit: str = "", most: float = math.inf, why: str = "") -> float:
    """A positive finite number as a float."""
    number = finite(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} is {_with_unit(number, unit)}; give a positive number")
    return finite(name, number, unit, most, why)


def not_negative(name: str, value: Any, unit: str = "") -> float:
    """A finite number of 0 or more as a float."""
    number = finite(name, value, unit)
    if number < 0:
        raise ValueError(f"{name} is {_with_unit(number, unit)}; give 0 or more")
    return number


def whole(name: str, value: Any, least: int, most: int | None = None, because: str = "") -> int:
    """A whole number as an int."""
    try:
        number = operator.index(_no_truth_value(value))
    except TypeError:
        number = least - 1
    if number < least:
        raise ValueError(f"{name} is {quoted(value)}; give a whole number from {least} up")
    if most is not None and number > most:
        raise ValueError(f"{name} is {number}; give at most {most}{because and f': {because}'}")
    return number


def words_of_error(error: BaseException) -> str:
    """Say in one line what went wrong in a user's own code, even if it ends the process."""
    text = " ".join(str(error).split())
    if isinstance(error, SystemExit):
        return f"it calls sys.exit({text}), which would end quietarm as well; leave that out"
    return f"{type(error).__name__}{': ' if text else ''}{text}"


def listed(names: Iterable[str]) -> str:
    """Names that a message lists, which may be a file's: each short, and not a page of them."""
    most = 40  # letters of a name
    return cut(", ".join(clipped(name, most) for name in names), _MOST_LISTED)


def joined(words: Iterable[str], last: str = "and") -> str:
    """Words with commas, and an "and", or another word, before the last."""
    *front, end = list(words) or [""]
    return f"{', '.join(front)} {last} {end}" if front else end


def with_article(noun: str) -> str:
    """A noun behind its indefinite article: a plan, an amount, an hour."""
    silent = ("hour", "honest", "heir")
    sounded = ("uni", "use", "usu", "eu", "one", "ur")  # as of "you" or "one"
    word = noun.lower()
    vowel = word.startswith((*"aeiou", *silent)) and not word.startswith(sounded)
    return f"{'an' if vowel else 'a'} {noun}"


def unknown(what: str, name: str, known: Collection[str], also: str = "") -> str:
    """The message about a name that is not known."""
    return (
        f"unknown {what} {quoted(name)}{nearest(name, known)} (known: {_near(name, known)}{also})"
    )


def has_no(owner: str, what: str, name: str, known: Collection[str]) -> str:
    """The message about a name that something does not have."""
    names = _near(name, known) or "none"
    return f"{owner} has no {what} {quoted(name)}{nearest(name, known)} (it has: {names})"


def _near(name: str, known: Collection[str]) -> str:
    """List known names: all of a few, and of many those that are most like the unknown one."""
    few = 13  # the commands are so many
    shown = 6
    if len(known) <= few:
        return listed(known)
    alike = difflib.SequenceMatcher(b=name.lower())

    def likeness(other: str) -> float:
        alike.set_seq1(other.lower())
        return alike.ratio()

    near = sorted(known, key=likeness, reverse=True)[:shown]
    return f"{listed(near)} and {len(known) - shown} more"


def nearest(name: str, known: Collection[str]) -> str:
    """A question for a message, with the known name that is most like an unknown one."""
    near = nearest_name(name, known)
    return f"; did you mean {quoted(near)}?" if near else ""


def how_named(names: Collection[str], known: Collection[str]) -> str:
    """Return how names differ from known ones: all by a prefix or an ending, or each by letters."""
    for place, rest in (("before", str.removesuffix), ("behind", str.removeprefix)):
        added = [{rest(name, other) for name in names} - {*names} for other in known]
        common = set[str].intersection(*added) - {""} if len(added) > 1 else set[str]()
        if common:
            more = quoted(min(common, key=len))
            return f"; these have {more} {place} their names in it, leave that out"
    alike = [nearest(name, known) for name in names]
    few = 2  # of more a list of questions is longer than the names
    return "".join(alike) if len([words for words in alike if words]) <= few else ""


def nearest_name(name: str, known: Collection[str]) -> str:
    """The known name that is most like another; an empty one where none is."""
    same = [other for other in known if spelling(other) == spelling(name)]
    part = [other for other in known if len(name) >= _PART and name.lower() in other.lower()]
    near = same or part or difflib.get_close_matches(name.lower(), list(known), n=1, cutoff=_ALIKE)
    return near[0] if near else ""


def spelling(name: str) -> str:
    """A name without what people spell differently: NSGA-II and nsga_2 are nsga2."""
    small = re.sub(r"[-_ ]", "", name.lower())
    return re.sub(r"i{2,3}$", lambda match: str(len(match[0])), small)


def install(extra: str) -> str:
    """Return the command that installs the libraries of an extra of this project."""
    return f"install it: pip install 'quietarm[{extra}]', or '.[{extra}]' in a clone"
