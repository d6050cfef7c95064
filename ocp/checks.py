"""Check the numbers and names that a user gives; a refusal names value and remedy."""

from __future__ import annotations

import inspect
import reprlib
import sys
import traceback
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import is_dataclass
from functools import cache, wraps
from os import PathLike
from typing import Annotated, Any, ParamSpec, TypeVar

import numpy as np
from msgspec import Meta
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.models.number_checks import (
    clipped,
    cut,
    finite,
    has_no,
    install,
    joined,
    listed,
    nearest,
    nearest_name,
    not_negative,
    numbers,
    positive,
    quoted,
    spelling,
    unknown,
    whole,
    with_article,
    words_of_error,
)

__all__ = [
    "IF_STATED",
    "Count",
    "CountFromOne",
    "NotNegative",
    "Positive",
    "Share",
    "clipped",
    "count_of",
    "cut",
    "failed_in",
    "finite",
    "forgotten_if_refused",
    "has_no",
    "hashable",
    "install",
    "instance",
    "joined",
    "known",
    "listed",
    "nearest",
    "nearest_name",
    "not_negative",
    "numbers",
    "object_of",
    "positive",
    "quoted",
    "several",
    "ships",
    "spelling",
    "table_of",
    "takes",
    "unknown",
    "whole",
    "with_article",
    "words_of_error",
]

T = TypeVar("T")
P = ParamSpec("P")
R = TypeVar("R")
IF_STATED: Mapping[str, bool] = {"if_stated": True}
"""Metadata of a field that a file has only where it states something, as earlier files may."""


def table_of(coefficients: ArrayLike, columns: int | None = None) -> NDArray[np.float64]:
    """Coefficients, a row for each motion; without `columns` any number of them, and a row."""
    if hasattr(coefficients, "filled"):  # to name numpy's class would load numpy.ma
        raise ValueError(
            "coefficients are a masked array; give plain numbers, as of its filled(value)"
        )
    wanted = "a row of numbers for each motion"
    table = numbers("coefficients", coefficients, wanted, infinite=True)
    fits = table.ndim == 2 and (len(table) > 0 if columns is None else table.shape[1] == columns)
    if not fits:
        raise ValueError(
            f"coefficients have shape {table.shape}; give (motions, {columns or 'coefficients'}), "
            "one row for each motion"
        )
    return table


def count_of(name: str, values: ArrayLike) -> int:
    """Count the numbers that are given; ValueError where no array can be made of them."""
    return numbers(name, values, "a list of numbers", infinite=True).size


def instance(name: str, value: Any, *kinds: type[T]) -> T:
    """A value that has to be of a class, or of one of several; TypeError that says what to give.

    The first class may have an `example`, which completes 'give ...'.
    """
    if isinstance(value, kinds):
        return value
    if no_task := getattr(value, "no_task", None):  # of a front of a function
        raise no_task()
    shown = value.__name__ if isinstance(value, type) else reprlib.repr(value)
    if is_dataclass(value) and not isinstance(value, type):
        shown = f"an object of {type(value).__name__}"  # all of its entries would say less
    raise TypeError(f"{name} is {shown}; give {_instead_of(value, kinds[0])}")


def several(name: str, value: Any, of: str) -> list[Any]:
    """A sequence as a list; ValueError where it is a single value, text, or has no order."""
    unordered = isinstance(value, str | bytes | Set | Mapping)
    if unordered or not isinstance(value, Iterable):
        raise ValueError(f"{name} is {quoted(value)}; give a list of {of}")
    return list(value)


def hashable(name: str, value: object) -> None:
    """Refuse an object that may change; TypeError says how to write its class."""
    if type(value).__hash__ is None:
        raise TypeError(
            f"{name} {type(value).__name__} has no hash; make its class a frozen dataclass of "
            "numbers, strings and tuples"
        )


def _instead_of(value: Any, kind: type[Any]) -> str:
    """Say what to give: an object of the class that was given or named, else its example."""
    meant = value if isinstance(value, type) and issubclass(value, kind) else None
    if isinstance(value, str):
        named = known(kind)
        complete = {name: entry for name, entry in named.items() if not _needed(entry)}
        # a class that needs nothing works as it stands in the message
        meant = complete.get(nearest_name(value, complete)) or named.get(nearest_name(value, named))
    if meant is not None:
        return f"an object, such as {_construction(meant)}"
    if isinstance(value, str | PathLike) and hasattr(kind, "load"):
        return f"{kind.__name__}.load({quoted(str(value))})"
    return getattr(kind, "example", f"an object of {kind.__name__}")


def _construction(kind: type[Any]) -> str:
    """Say how an object of a class is made, with the arguments that it needs."""
    return f"{kind.__name__}({', '.join(_needed(kind))})"


def object_of(kind: Any) -> Any:
    """Make an object of a class without arguments; ValueError if it needs some.

    Of a class that ships it is always the same. One of the user's may be defined again.
    """
    return _shipped_object(kind) if ships(kind) else _new_object(kind)


def _new_object(kind: Any) -> Any:
    if needed := _needed(kind):
        raise ValueError(f"{kind.__name__} needs {', '.join(needed)}; give each a default")
    return kind()


_shipped_object = cache(_new_object)


def _needed(kind: type[Any]) -> list[str]:
    """Arguments without which no object of a class is made."""
    parameters = inspect.signature(kind).parameters.items()
    return [name for name, parameter in parameters if parameter.default is parameter.empty]


def name_of_file(path: Any) -> None:
    """Refuse what names no file; TypeError that says what to give."""
    if not isinstance(path, str | PathLike):
        raise TypeError(
            f"path is {reprlib.repr(path)}; give the name of a file, such as 'plan.json'"
        )


Kind = type[Any] | list[type[Any]] | dict[type[str], type[Any]]
"""A class; in a list for a sequence of its objects, or for objects by name as `{str: Plan}`."""


def takes(**kinds: Kind) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Check arguments of a public function by name: each is of its kind, or the default.

    No Ctrl-C is lost in it.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        parameters = inspect.signature(function)

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            try:
                arguments = parameters.bind_partial(*args, **kwargs).arguments
            except TypeError:  # the function's own error says more
                return function(*args, **kwargs)
            for name, kind in kinds.items():
                default = parameters.parameters[name].default
                value = arguments.get(name, default)
                if value is not default:
                    _check_kind(name, value, kind)
            return function(*args, **kwargs)

        return interruptible(checked)

    return decorate


def _check_kind(name: str, value: Any, kind: Kind) -> None:
    if isinstance(kind, dict):
        if not isinstance(value, Mapping):
            example = f"{{'mine': {name[:-1]}}}"
            raise TypeError(
                f"{name} is {reprlib.repr(value)}; give them by name, such as {example}"
            )
        for key, entry in value.items():
            instance(f"{name} {quoted(key)}", entry, kind[str])
    elif isinstance(kind, list):
        (entry_kind,) = kind
        if isinstance(value, entry_kind | str) or not isinstance(value, Collection):
            what = f"a list of objects of {entry_kind.__name__}"
            raise TypeError(f"{name} is {reprlib.repr(value)}; give {what}")
        for number, entry in enumerate(value, start=1):
            instance(f"{name} {number}", entry, entry_kind)
    else:
        instance(name, value, kind)


def known(family: type[T]) -> dict[str, type[T]]:
    """The subclasses that have a name of their own, by it, those of the user's own files too.

    A class of the user's may be defined again, as in a notebook's cell; ValueError where it takes
    the name of one of quietarm's.
    """
    classes: dict[str, type[T]] = {}
    for kind in _descendants(family):
        name = vars(kind).get("name")
        if not isinstance(name, str):
            continue
        if name in classes and ships(classes[name]) and not ships(kind):
            raise ValueError(
                f"name {quoted(name)} of {kind.__name__} is that of quietarm's "
                f"{classes[name].__name__}; give {kind.__name__} another"
            )
        classes[name] = kind
    return classes


def _descendants(family: type[T]) -> list[type[T]]:
    """All subclasses; quietarm's own first, else in the order of their definitions."""
    descendants: list[type[T]] = []
    for kind in family.__subclasses__():
        descendants += [kind, *_descendants(kind)]
    return sorted(descendants, key=lambda kind: not ships(kind))


def ships(kind: type[Any]) -> bool:
    """Return whether a class comes with quietarm."""
    return kind.__module__.startswith("quietarm.")


@contextmanager
def forgotten_if_refused(kind: Any) -> Iterator[None]:
    """Take the name from a class whose definition is refused: it may live on, and is not known."""
    try:
        yield
    except ValueError:
        kind.name = None
        raise


def failed_in(what: str, kind: type[Any], error: BaseException) -> ValueError:
    """Return the error of lines that fail in a user's class: what, where and why, in one line."""
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    place = f" ({file}, line {lines[-1]})" if lines else ""
    return ValueError(f"{what}{place} fails: {words_of_error(error)}; mend it")


NotNegative = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
Share = Annotated[float, Meta(ge=0, le=1)]
Count = Annotated[int, Meta(ge=0)]
CountFromOne = Annotated[int, Meta(ge=1)]
