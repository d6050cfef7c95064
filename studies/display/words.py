"""Words on the screen: lines that stay whole, lengths in millimetres."""

from __future__ import annotations

from rich.console import Console


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console."""
    console.print("\n".join(lines), markup=False, highlight=False, soft_wrap=True)


def counted(number: int, what: str) -> str:
    """How many of what, as in 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.3g} mm"
