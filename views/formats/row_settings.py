"""Settings of formats whose files are rows or points at a rate."""

from __future__ import annotations

from quietarm.ocp.planning.move_table import USUAL_COLUMNS, USUAL_RATE
from quietarm.views.formats.export_format import ExportSetting

COLUMNS = ExportSetting(
    "columns", USUAL_COLUMNS, "Columns, with units: time:ms,angle:deg,speed,acceleration,jerk,"
    "tip:mm,torque,power.",
)  # fmt: skip
CYCLE = ExportSetting(
    "cycle", 0.001, "Time between two calls [s], for what is said of it.", 1e-6, 1e3, unit="s"
)
RATE = ExportSetting("rate", USUAL_RATE, "Rows or points in a second [Hz].", unit="Hz")
