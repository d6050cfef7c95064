"""A move as a MATLAB v5 file."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from quietarm.ocp import Plan
from quietarm.ocp.escapes import matlab_names
from quietarm.ocp.planning.move_table import move_table
from quietarm.views.formats.between_rows import note_of_rows
from quietarm.views.formats.export_format import ExportFormat
from quietarm.views.formats.row_settings import COLUMNS, RATE


class MatlabFile(ExportFormat):
    """A column vector for each column, the coefficients and the duration.

    Names of several joints are a cell array as well, as they are.
    """

    name = "mat"
    endings = (".mat",)
    meaning = "a MATLAB v5 file"
    settings = (COLUMNS, RATE)

    def content(self, plan: Plan, *args: Any, columns: str, rate: float) -> bytes:
        """All variables."""
        from scipy.io import savemat  # slow to load

        file = io.BytesIO()
        rows = move_table(plan, columns, rate)
        vectors = dict(zip(matlab_names(rows), rows.values()))
        facts: dict[str, Any] = {
            "coefficients": plan.coefficients,
            "duration_s": plan.task.duration,
        }
        joints = plan.task.plant.joint_names
        if len(joints) > 1:
            facts["joint_names"] = np.array(joints, dtype=object)
        savemat(file, {**facts, **vectors}, oned_as="column")
        return file.getvalue()

    def note(self, plan: Plan, *args: Any, columns: str, rate: float) -> str:
        """Say what a controller leaves that interpolates between the rows, if it matters."""
        return note_of_rows(plan, columns, rate)
