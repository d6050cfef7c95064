"""Names that are not known, and what a user may have meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_ALIKE = 0.55
"""Share of letters in common from which on a name is asked for."""
_PART = 3
"""So many letters of a longer name are enough."""


def unknown(what: str, name: str, known: Iterable[str], also: str = "") -> str:
    """The message about a name that is not known."""
    known = list(known)
    return f"unknown {what} {name!r}{_question(name, known)} (known: {', '.join(known)}{also})"


def has_no(owner: str, what: str, name: str, known: Iterable[str]) -> str:
    """The message about a name that something does not have."""
    known = list(known)
    listed = ", ".join(known) or "none"
    return f"{owner} has no {what} {name!r}{_question(name, known)} (it has: {listed})"


def nearest(name: str, known: Iterable[str]) -> str:
    """A question for a message, with the known name that is most like an unknown one."""
    known = list(known)
    part = [other for other in known if len(name) >= _PART and name.lower() in other.lower()]
    near = part or difflib.get_close_matches(name.lower(), known, n=1, cutoff=_ALIKE)
    return f"did you mean {near[0]!r}? " if near else ""


def _question(name: str, known: list[str]) -> str:
    question = nearest(name, known).rstrip()
    return f"; {question}" if question else ""
