"""Names that are not known, and what a user may have meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_ALIKE = 0.55
"""Share of letters in common from which on a name is asked for."""
_PART = 3
"""So many letters of a longer name are enough."""


def unknown(what: str, name: object, known: Iterable[str], also: str = "") -> str:
    """The message about a name that is not known.

    Parameters
    ----------
    what : str
        What it should name, as ``"plant"``.
    name : str
        What was typed.
    known : iterable of str
        What there is.
    also : str
        What else there is, behind the list, as ``"; your own by its --plant-file"``.

    Returns
    -------
    str
        As ``"unknown plant 'singel'; did you mean 'single-link'? (known: ...)"``; without the
        question where no name is like it.
    """
    known = list(known)
    return f"unknown {what} {name!r}{_question(name, known)} (known: {', '.join(known)}{also})"


def has_no(owner: str, what: str, name: object, known: Iterable[str]) -> str:
    """The message about a name that something does not have.

    Parameters
    ----------
    owner : str
        What does not have it, as ``"single-link"``.
    what : str
        What it should name, as ``"parameter"``.
    name : str
        What was typed.
    known : iterable of str
        What it has.

    Returns
    -------
    str
        As ``"single-link has no parameter 'omga'; did you mean 'omega'? (it has: ...)"``; without
        the question where no name is like it.
    """
    known = list(known)
    listed = ", ".join(known) or "none"
    return f"{owner} has no {what} {name!r}{_question(name, known)} (it has: {listed})"


def nearest(name: str, known: Iterable[str]) -> str:
    """A question for a message, with the known name that is most like an unknown one.

    Parameters
    ----------
    name : str
        What was typed.
    known : iterable of str
        What there is.

    Returns
    -------
    str
        As ``"did you mean 'omega'? "``, with the space; empty where no name is like it.
    """
    known = list(known)
    part = [other for other in known if len(name) >= _PART and name.lower() in other.lower()]
    near = part or difflib.get_close_matches(name.lower(), known, n=1, cutoff=_ALIKE)
    return f"did you mean {near[0]!r}? " if near else ""


def _question(name: object, known: list[str]) -> str:
    if not isinstance(name, str):
        return ""
    question = nearest(name, known).rstrip()
    return f"; {question}" if question else ""
