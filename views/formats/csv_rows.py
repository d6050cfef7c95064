"""A move as comma-separated values under a heading."""

from __future__ import annotations

from typing import Any

from quietarm.ocp import Plan
from quietarm.ocp.planning.move_table import move_csv
from quietarm.views.formats.between_rows import note_of_rows
from quietarm.views.formats.export_format import ExportFormat
from quietarm.views.formats.row_settings import COLUMNS, RATE


class CsvRows(ExportFormat):
    """Chosen columns, in chosen units, at a rate."""

    name = "csv"
    endings = (".csv",)
    meaning = "a table"
    settings = (COLUMNS, RATE)
    to_stdout = True

    def content(self, plan: Plan, *args: Any, columns: str, rate: float) -> str:
        """A heading, and a row a tick."""
        return move_csv(plan, columns, rate)

    def note(self, plan: Plan, *args: Any, columns: str, rate: float) -> str:
        """Say what a controller leaves that interpolates between the rows, if it matters."""
        return note_of_rows(plan, columns, rate)
