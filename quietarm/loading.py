"""Packages whose names are imported when they are first asked for; no Ctrl-C leaves half of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import lazy_loader

from quietarm.interrupts import interruptible


def attach(
    package: str, file: str, moved: Mapping[str, str] | None = None
) -> tuple[Callable[[str], Any], Callable[[], list[str]], Any]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package, by `lazy_loader.attach_stub`.

    ImportError of a name that has moved says where to: an AttributeError would lose its words in
    ``from quietarm import name``.
    """
    load, listed, names = lazy_loader.attach_stub(package, file)

    def load_or_say(name: str) -> Any:
        if moved and name in moved:
            raise ImportError(f"{package}.{name} has moved to {moved[name]}", name=name)
        return load(name)

    return interruptible(load_or_say), listed, names
