"""Certificates of exact fronts on the screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from quietarm.metaheuristics.problems.certificate import Certificate
from quietarm.studies.document.blocks import Document, Lines
from quietarm.studies.document.table import Cell, Column, Table


def certificates_document(found: Sequence[Certificate]) -> Document:
    """What was checked of every front."""
    columns = [
        Column("front"), Column("points"), Column("optimal by the solver"),
        Column("starts to beat it"), Column("beaten by at most", "{:.1e}".format),
        Column("energy by CVODES differs by", "{:.1e}".format),
        Column("residual by CVODES differs by [m]", "{:.1e}".format),
        Column("energy by fixed steps differs by", "{:.1e}".format),
        Column("residual by fixed steps differs by", "{:.1e}".format),
    ]  # fmt: skip
    rows: list[list[Cell]] = [
        [one.front, one.points, one.confirmed, one.tried, one.gained, one.energy_difference,
         one.residual_difference, one.energy_by_steps, one.residual_by_steps]
        for one in found
    ]  # fmt: skip
    table = Table("Exact fronts, checked anew", columns, rows)
    return Document("", [table, Lines([f"SHA-256 {one.checksum}  {one.front}" for one in found])])


def not_holding(found: Sequence[Certificate], kept: Mapping[str, Certificate]) -> list[str]:
    """Which fronts are not what their certificates say, in words."""
    words = list[str]()
    for one in found:
        known = kept.get(one.front)
        if known is None or known.checksum != one.checksum:
            words.append(f"{one.front} is not what was certified; install quietarm again")
        elif not one.holds:
            words.append(
                f"{one.front} is beaten by {one.gained:.1e} of the energy, or integrators differ"
            )
    return words
