"""Words on the screen: lines that stay whole and move no cursor, lengths in millimetres."""

from __future__ import annotations

from rich.console import Console

from ocp.base.printable import printable


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console."""
    text = "\n".join(printable(line) for part in lines for line in part.split("\n"))
    console.print(text, markup=False, highlight=False, soft_wrap=True)


def counted(number: int, what: str) -> str:
    """How many of what, as in 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.3g} mm"
