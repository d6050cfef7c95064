"""Words on the screen: lines that stay whole, lengths in millimetres, plants."""

from __future__ import annotations

from dataclasses import fields

from rich.console import Console

from models import Plant


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console."""
    console.print("\n".join(lines), markup=False, highlight=False, soft_wrap=True)


def counted(number: int, what: str) -> str:
    """How many of what, as in 1 point, 2 points."""
    return f"{number} {what}{'s' * (number != 1)}"


def millimetres(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.3g} mm"


def plant_words(plant: Plant) -> str:
    """A plant's name, with the parameters that differ from those of its class."""
    changed: list[str] = []
    for entry in fields(plant):
        value, unit = plant.parameters[entry.name], entry.metadata.get("unit", "-")
        if value != entry.default:
            changed.append(f"{entry.name} = {value:.6g}{'' if unit == '-' else f' {unit}'}")
    return f"{plant.name} with {', '.join(changed)}" if changed else plant.name
