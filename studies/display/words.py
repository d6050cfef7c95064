"""Words on the screen: lines that stay whole and move no cursor, lengths in millimetres."""

from __future__ import annotations

from unicodedata import category

from rich.console import Console


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console."""
    text = "\n".join(map(printable, lines))
    console.print(text, markup=False, highlight=False, soft_wrap=True)


def printable(text: str) -> str:
    """A text whose control characters are spelled out, as those in the name of a file."""
    control = {c: c.encode("unicode_escape").decode() for c in text if category(c) == "Cc"}
    return text.translate(str.maketrans(control))


def counted(number: int, what: str) -> str:
    """How many of what, as in 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.3g} mm"
