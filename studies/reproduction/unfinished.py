"""What a reproduction that was interrupted had computed."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL
from quietarm.metaheuristics.sharing.pieces import Done, Piece
from quietarm.ocp import Floor, Front, Plan
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.reproduction.side_by_side.results import System

FILE = "unfinished.csv"


def unfinished_table(pieces: Sequence[Piece], done: Done) -> Table:
    """Energy and residual of every piece of work that came to its end, one row for each."""
    columns = [
        Column("piece of work", key="piece"),
        Column("F2 [J]", key="energy_J"),
        Column("residual [mm]", "{:.3g}".format, "residual_mm"),
    ]
    rows = [
        [piece.name, *_figures(done.answers[piece.key])]
        for piece in pieces
        if piece.key in done.answers
    ]
    return Table("What was done before the interruption", columns, rows)


def _figures(answer: Plan | Floor | Front | tuple[System, ...] | str) -> list[Cell]:
    if isinstance(answer, tuple | str):
        return [None, None]
    if not isinstance(answer, Front):
        return [answer.energy, 1e3 * answer.motion.residual]
    still = [point for point in answer.points if point.residual <= SEARCH_RESIDUAL]
    return [still[-1].energy, 1e3 * still[-1].residual] if still else [None, None]
