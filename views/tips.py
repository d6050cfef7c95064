"""A tip's displacements as they are shown: in millimetres, or in rad where the tip turns."""

from __future__ import annotations


def tip_scale(tip_unit: str) -> tuple[str, float]:
    """The unit that is shown for a plant's `tip_unit`, and the factor to it."""
    return ("mm", 1e3) if tip_unit == "m" else (tip_unit, 1.0)


def tip_words(displacement: float, tip_unit: str) -> str:
    """A displacement in the unit that is shown."""
    shown, factor = tip_scale(tip_unit)
    return f"{factor * displacement:.3g} {shown}"
