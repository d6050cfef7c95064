"""An identified machine on the screen: what its recordings tell, and how well they are met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from math import floor, log10, pi

from quietarm.models import Plant
from quietarm.studies.document.blocks import Document, Facts, Lines
from quietarm.studies.identify import Estimate, Identified
from quietarm.studies.identify.answer import POOR

_BY = {"fit": "by the fit", "spread": "by the spread between parts"}


def identified_document(found: Identified) -> Document:
    """The parameters with their intervals, then each part of the recordings."""
    rows = [("plant", found.plant.name)]
    rows += [(one.parameter, _told(found.plant, one)) for one in found.told]
    rows += [
        (name, f"not told: {why}; {getattr(found.plant, name):.4g} as given")
        for name, why in found.untold.items()
    ]
    known = {one.parameter for one in found.told} | found.untold.keys()
    given = [name for name in found.plant.measured if name not in known]
    if given:
        rows.append(("as given", ", ".join(_with_unit(found.plant, name) for name in given)))
    for part in found.parts:
        held = "" if part.held_back is None else f", {part.held_back:.1%} by the fit of the others"
        rows.append(
            (part.recording, f"{part.begin:.3g} to {part.end:.3g} s, {part.misfit:.1%} left{held}")
        )
    rows += [(name, "no ring-down of two periods in it: left out") for name in found.left_out]
    return Document("", [Facts(rows), Lines(_notes(found, given))])


def _notes(found: Identified, given: Sequence[str]) -> list[str]:
    """What is to be known before the intervals are believed."""
    notes = ["What is left is the root mean square, as a share of the recorded signal's."]
    if given:
        notes.append(
            "Torque and energy depend on what is as given: set what you know by --set, as "
            f"{given[0]}={getattr(found.plant, given[0]):.4g}."
        )
    if len(found.parts) == 1:
        notes.append(
            "One ring-down does not tell whether the machine is always the same: give several."
        )
    return notes + [
        f"warning: {part.recording}: {part.misfit:.0%} is left, so that its interval says nothing. "
        "Did the joint move? Name its angle by --angle, or leave the recording out."
        for part in found.parts
        if part.misfit > POOR
    ]


def _with_unit(plant: Plant, name: str) -> str:
    unit = _unit(plant, name)
    return f"{name} {getattr(plant, name):.4g}{'' if unit == '-' else f' {unit}'}"


def _unit(plant: Plant, name: str) -> str:
    return next(one.metadata.get("unit", "-") for one in fields(plant) if one.name == name)


def _told(plant: Plant, one: Estimate) -> str:
    unit = _unit(plant, one.parameter)
    size, words = 1.0, "" if unit == "-" else f" {unit}"
    if unit == "rad/s":
        size, words = 2 * pi, " Hz"
    digits = max(3, 1 - floor(log10(one.error)))  # two of the interval
    value, low, high = (f"{x / size:.{digits}g}" for x in (one.value, one.low, one.high))
    return f"{value}{words}, within {low} to {high}{words} (95 %, {_BY[one.by]})"
