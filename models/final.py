"""Methods that no subclass overrides, because what is checked relies on them."""

from __future__ import annotations

from typing import Any


def refuse_overridden(kind: type[Any], base: type[Any], instead: str) -> None:
    """TypeError where a class has another method for one that its base marks by `typing.final`.

    Parameters
    ----------
    kind, base : type
        The subclass, and the class whose own methods count.
    instead : str
        What to override instead, for the message.
    """
    for name, method in vars(base).items():
        function = getattr(method, "fget", None) or getattr(method, "__func__", method)
        if not getattr(function, "__final__", False):
            continue
        owner = next(ancestor for ancestor in kind.__mro__ if name in vars(ancestor))
        if owner is not base:
            raise TypeError(
                f"{kind.__name__} has its own {name}, which is {base.__name__}'s alone, because "
                f"what is checked relies on it; override {instead}"
            )
