"""A dict that answers can hold: it cannot be changed."""

from __future__ import annotations

from typing import Any, NoReturn


class ReadOnlyDict(dict[str, Any]):
    """A dict whose entries stay as they were given; equal to any dict with the same entries.

    It saves to JSON, copies and goes to other processes as a dict does.
    """

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("the entries of an answer cannot be changed; copy them with dict(...)")

    __setitem__ = __delitem__ = __ior__ = _refuse  # type: ignore[assignment]
    update = pop = popitem = clear = setdefault = _refuse  # type: ignore[assignment]

    def __hash__(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        return hash(frozenset(self))  # entries may be lists: names alone must do

    def __reduce__(self) -> tuple[type[ReadOnlyDict], tuple[dict[str, Any]]]:
        return ReadOnlyDict, (dict(self),)
