"""A move over its duration: a table for people, and one for machines."""

from __future__ import annotations

from math import degrees

from quietarm.ocp.front.durations import OverDuration
from quietarm.studies.display.words import REST, plant_words
from quietarm.studies.document.blocks import Bullets, Document, Text
from quietarm.studies.document.table import Cell, Column, Table


def durations_document(found: OverDuration) -> Document:
    """A line for each duration, and why some have no plan."""
    missing = [f"{one.duration:.4g} s: {one.why}" for one in found.points if one.why]
    words = (
        "The floor is the least energy of any motion, within 2 %, at rest on arrival; the plain "
        "cycloid keeps no limits."
    )
    task, times = found.task, [one.duration for one in found.points]
    angles = f"{degrees(task.start):.6g} to {degrees(task.target):.6g} deg"
    title = f"{plant_words(task.plant)}, {angles} in {min(times):g} to {max(times):g} s"
    table = durations_table(found, shown=True).turned()
    return Document(title, [table, Bullets(missing, soft=True), Text(words, soft=True)])


def durations_table(found: OverDuration, shown: bool = False) -> Table:
    """Energies and residuals, a row a duration; for people, residuals of rest say so."""
    columns = [
        Column("duration [s]", "{:.4g}".format, "duration_s"),
        Column("plan [J]", "{:.4g}".format, "plan_J"),
        Column("floor [J]", "{:.4g}".format, "floor_J"),
        Column("cycloid [J]", "{:.4g}".format, "cycloid_J"),
        Column("plan leaves [mm]", "{:.3g}".format, "plan_mm"),
        Column("cycloid leaves [mm]", "{:.3g}".format, "cycloid_mm"),
    ]
    rows: list[list[Cell]] = []
    for one in found.points:
        plan = one.plan
        left: Cell = None if plan is None else 1e3 * plan.residual
        if shown:
            left = "none" if plan is None else "rest" if plan.residual < REST else left
        rows.append([
            f"{one.duration:.4g}" if shown else one.duration,
            None if plan is None else plan.energy, one.floor, one.cycloid.energy,
            left, 1e3 * one.cycloid.residual,
        ])  # fmt: skip
    return Table("durations", columns, rows)
