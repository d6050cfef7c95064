"""The forms that a plan is exported in, each with what writes it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from quietarm.ocp import Plan
from quietarm.ocp.checks import positive, unknown
from quietarm.ocp.files import write_whole
from quietarm.studies.export.c_source import c_files
from quietarm.studies.export.tables import columns_of, csv_text, mat_bytes, ros_text, table

COLUMNS, RATE, JOINT = "time,angle,speed,acceleration", 1000.0, "joint"


class Format(NamedTuple):
    """The endings of a form's files, and what of `export_plan` it takes."""

    endings: tuple[str, ...]
    takes: tuple[str, ...] = ()


FORMATS = {
    "csv": Format((".csv",), ("columns", "rate")),
    "c": Format((".c",)),
    "ros": Format((".yaml", ".yml"), ("rate", "joint")),
    "mat": Format((".mat",), ("columns", "rate")),
}


def format_of(path: Path) -> str:
    """The format of a file by its ending; ValueError where it says none."""
    ending = path.suffix.lower()
    for name, form in FORMATS.items():
        if ending in form.endings:
            return name
    if ending == ".h":
        raise ValueError(f"{path} is written beside its C source; give {path.with_suffix('.c')}")
    known = ", ".join(one for form in FORMATS.values() for one in form.endings)
    raise ValueError(f"{path} does not say in which form it is; end its name in one of {known}")


def export_moves(dataset: Path, path: Path, format: str | None = None) -> list[Path]:  # noqa: A002
    """Write the moves of a sweep's dataset as C: a table, and what interpolates it."""
    from quietarm.studies.export.c_table import c_table_files
    from quietarm.studies.sweep.library import MoveLibrary

    if (format or format_of(path)) != "c" or path.suffix != ".c":
        raise ValueError(f"{dataset} has many moves, which are exported as C alone; give a .c file")
    return _write_c(path, c_table_files(MoveLibrary(dataset), path.stem))


def _write_c(path: Path, contents: tuple[str, str]) -> list[Path]:
    """Write header and source, the header first."""
    files = [path.with_suffix(".h"), path]
    for file, content in zip(files, contents, strict=True):
        write_whole(file, content)
    return files


def export_plan(
    plan: Plan,
    path: str | Path,
    format: str | None = None,  # noqa: A002  # as other libraries call it
    *,
    columns: str = COLUMNS,
    rate: float = RATE,
    joint: str = JOINT,
) -> list[Path]:
    """Write a plan in a form that a controller reads.

    Parameters
    ----------
    plan : Plan
        The move.
    path : str or Path
        The file; beside a C source `move.c` its header `move.h` is written.
    format : {"csv", "c", "ros", "mat"}, optional
        A table, C source, a ROS 2 JointTrajectory in YAML, or MATLAB v5; by the file's ending
        where none is given.
    columns : str
        Of a table, with units: ``"time:ms,angle:deg,torque"``.
    rate : float
        Rows of a table, or points of a trajectory, in a second [Hz].
    joint : str
        The joint's name, for ROS.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ValueError
        When a name, a unit or a rate is out of range.
    """
    path = Path(path)
    name = format or format_of(path)
    if name not in FORMATS:
        raise ValueError(unknown("format", name, FORMATS))
    if path.suffix and format_of(path) != name:
        raise ValueError(f"{path} is no name for {name}; end it in {FORMATS[name].endings[0]}")
    rate = positive("sample rate", rate, "Hz")
    if name == "c":
        return _write_c(path, c_files(plan, path.stem))
    write_whole(path, _content(plan, name, columns, rate, joint))
    return [path]


def _content(plan: Plan, name: str, columns: str, rate: float, joint: str) -> str | bytes:
    if name == "ros":
        return ros_text(plan, joint, rate)
    rows = table(plan, columns_of(columns), rate)
    facts = {"coefficients": plan.coefficients, "duration_s": plan.task.duration}
    return csv_text(rows) if name == "csv" else mat_bytes(rows, facts)
