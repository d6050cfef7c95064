"""Words on the screen: lines that stay whole, lengths in millimetres, moves and tasks."""

from __future__ import annotations

from math import degrees

from rich.console import Console

from ocp import PointToPoint
from ocp.task.quantities import QUANTITIES


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console."""
    console.print("\n".join(lines), markup=False, highlight=False, soft_wrap=True)


def counted(number: int, what: str) -> str:
    """How many of what, as in 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.3g} mm"


def move_of(task: PointToPoint) -> str:
    """The move of a task: "0 to 30 deg in 0.8 s"."""
    return f"{degrees(task.start):.6g} to {degrees(task.target):.6g} deg in {task.duration:g} s"


def title_of(task: PointToPoint) -> str:
    """A task in a line: its plant and move; its limits where it has any."""
    limits = [
        f"{name} within {value:g} {QUANTITIES[name].unit}" for name, value in task.limits.items()
    ]
    return ", ".join([task.plant.name, move_of(task), *limits])
