"""The forms that a plan is exported in, each with what writes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from quietarm.ocp import Plan
from quietarm.ocp.checks import positive, unknown
from quietarm.ocp.files import write_whole
from quietarm.studies.export.c_source import c_files
from quietarm.studies.export.tables import (
    USUAL,
    columns_of,
    csv_text,
    mat_bytes,
    ros_text,
    table,
)


@dataclass(frozen=True)
class Wishes:
    """What a controller wants; see `export_plan`."""

    columns: str = ",".join(USUAL)
    rate: float = 1000.0
    joint: str = "joint"


Files = dict[Path, str | bytes]


def _csv(plan: Plan, path: Path, wishes: Wishes) -> Files:
    return {path: csv_text(table(plan, columns_of(wishes.columns), wishes.rate))}


def _c(plan: Plan, path: Path, wishes: Wishes) -> Files:
    header, source = c_files(plan, path.stem)
    return {path.with_suffix(".h"): header, path: source}


def _ros(plan: Plan, path: Path, wishes: Wishes) -> Files:
    return {path: ros_text(plan, wishes.joint, wishes.rate)}


def _mat(plan: Plan, path: Path, wishes: Wishes) -> Files:
    columns = table(plan, columns_of(wishes.columns), wishes.rate)
    facts = {"coefficients": plan.coefficients, "duration_s": plan.task.duration}
    return {path: mat_bytes(columns, facts)}


class Format(NamedTuple):
    """The endings of a form's files, what makes them, and which wishes it takes."""

    endings: tuple[str, ...]
    make: Callable[[Plan, Path, Wishes], Files]
    takes: tuple[str, ...]


FORMATS = {
    "csv": Format((".csv",), _csv, ("columns", "rate")),
    "c": Format((".c",), _c, ()),
    "ros": Format((".yaml", ".yml"), _ros, ("rate", "joint")),
    "mat": Format((".mat",), _mat, ("columns", "rate")),
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
    """Write the moves of a sweep's dataset as C: a table, and what interpolates it.

    Parameters
    ----------
    dataset : Path
        Of `quietarm sweep`.
    path : Path
        The C source; its header is written beside it.
    format : {"c"}, optional
        The only form that there is.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ValueError
        When another form is asked for, or no function of C can be called after the file.
    """
    from quietarm.studies.export.c_table import c_table_files
    from quietarm.studies.sweep.library import MoveLibrary

    if (format or format_of(path)) != "c" or path.suffix != ".c":
        raise ValueError(f"{dataset} has many moves, which are exported as C alone; give a .c file")
    header, source = c_table_files(MoveLibrary(dataset), path.stem)
    for file, content in ((path.with_suffix(".h"), header), (path, source)):
        write_whole(file, content)
    return [path.with_suffix(".h"), path]


def export_plan(
    plan: Plan,
    path: str | Path,
    format: str | None = None,  # noqa: A002  # as other libraries call it
    *,
    columns: str = Wishes.columns,
    rate: float = Wishes.rate,
    joint: str = Wishes.joint,
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
    form = FORMATS[name]
    if path.suffix and format_of(path) != name:
        raise ValueError(f"{path} is no name for {name}; end it in {form.endings[0]}")
    wishes = Wishes(columns, positive("sample rate", rate, "Hz"), joint)
    files = form.make(plan, path, wishes)
    for file, content in files.items():
        write_whole(file, content)
    return list(files)
