"""Names that a user may have meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


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
    part = [other for other in known if name and name.lower() in other.lower()]
    near = part or difflib.get_close_matches(name.lower(), known, n=1, cutoff=0.3)
    return f"did you mean {near[0]!r}? " if near else ""
