"""An identified machine on the screen: what its recordings tell, and how well they are met."""

from __future__ import annotations

from dataclasses import fields
from math import floor, log10, pi

from quietarm.models import Plant
from quietarm.ocp import Estimate, Identified
from quietarm.studies.document.blocks import Document, Facts, Lines

_BY = {"fit": "by the fit", "spread": "by the spread between parts"}


def identified_document(found: Identified) -> Document:
    """The parameters with their intervals, then each part of the recordings."""
    rows = [("plant", found.plant.name)]
    rows += [(one.parameter, _told(found.plant, one)) for one in found.told]
    rows += [
        (name, f"not told: {why}; {getattr(found.plant, name):.4g} as given")
        for name, why in found.untold.items()
    ]
    for part in found.parts:
        held = "" if part.held_back is None else f", {part.held_back:.1%} by the fit of the others"
        rows.append(
            (part.recording, f"{part.begin:.3g} to {part.end:.3g} s, {part.misfit:.1%} left{held}")
        )
    rows += [(name, "no ring-down of two periods in it: left out") for name in found.left_out]
    note = "What is left is the root mean square, as a share of the recorded signal's."
    return Document("", [Facts(rows), Lines([note])])


def _told(plant: Plant, one: Estimate) -> str:
    unit = next(
        entry.metadata.get("unit", "-") for entry in fields(plant) if entry.name == one.parameter
    )
    size, words = 1.0, "" if unit == "-" else f" {unit}"
    if unit == "rad/s":
        size, words = 2 * pi, " Hz"
    digits = max(3, 1 - floor(log10(one.error)))  # two of the interval
    value, low, high = (f"{x / size:.{digits}g}" for x in (one.value, one.low, one.high))
    return f"{value}{words}, within {low} to {high}{words} (95 %, {_BY[one.by]})"
