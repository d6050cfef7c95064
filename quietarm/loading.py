"""Packages whose names are imported when they are first asked for; no Ctrl-C leaves half of one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import lazy_loader

from quietarm.interrupts import interruptible


def attach(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], Any]:
    """What `lazy_loader.attach_stub` gives: `__getattr__`, `__dir__` and `__all__` of a package."""
    load, listed, names = lazy_loader.attach_stub(package, file)
    return interruptible(load), listed, names
