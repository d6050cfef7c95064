"""The formats that moves are exported in, and what writes each."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quietarm.ocp import InfeasibleTaskError, Plan
from quietarm.ocp.checks import positive, unknown
from quietarm.ocp.files import write_whole
from quietarm.studies.export.tables import columns_of, csv_text, mat_bytes, ros_text, table

COLUMNS, RATE, FRAMES, JOINT = "time,angle,speed,acceleration", 1000.0, 25.0, "joint"
WIDTHS = 200, 2000
"""Least and largest width of a film [pixels]."""
_FILM = ("speed", "deflection_scale", "width", "rate")


@dataclass(frozen=True)
class Format:
    """The endings of a format's files, and what of `export` it takes."""

    endings: tuple[str, ...]
    takes: tuple[str, ...] = field(default=())

    @property
    def is_film(self) -> bool:
        """Whether it shows the structure in motion."""
        return self.takes == _FILM


FORMATS = {
    "csv": Format((".csv",), ("columns", "rate")),
    "c": Format((".c",)),
    "ros": Format((".yaml", ".yml"), ("rate", "joint")),
    "mat": Format((".mat",), ("columns", "rate")),
    "gif": Format((".gif",), _FILM),
    "mp4": Format((".mp4",), _FILM),
    "html": Format((".html",), _FILM),
}


def format_of(path: Path, format: str | None = None) -> str:  # noqa: A002
    """The format of a file: the one that is given, or by its ending; ValueError where neither."""
    ending = path.suffix.lower()
    by_ending = next((name for name, form in FORMATS.items() if ending in form.endings), None)
    if format is not None and format not in FORMATS:
        raise ValueError(unknown("format", format, FORMATS))
    name = format or by_ending
    if ending == ".h":
        raise ValueError(f"{path} is written beside its C source; give {path.with_suffix('.c')}")
    if name is None:
        known = ", ".join(one for form in FORMATS.values() for one in form.endings)
        raise ValueError(f"{path} does not say in which form it is; end its name in one of {known}")
    if by_ending not in (None, name):
        raise ValueError(f"{path} is no name for {name}; end it in {FORMATS[name].endings[0]}")
    return name


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
        Of a table, with units: ``"time:ms,angle:deg,torque"``. A robust plan has a column ``tip``
        for every scenario.
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
    name, rate = format_of(path, format), positive("sample rate", rate, "Hz")
    if name == "c":
        return _write_c(plan, path)
    if name == "ros":
        content: str | bytes = ros_text(plan, joint, rate)
    else:
        rows = table(plan, columns_of(columns, plan.task.plant.joint), rate)
        facts = {"coefficients": plan.coefficients, "duration_s": plan.task.duration}
        content = csv_text(rows) if name == "csv" else mat_bytes(rows, facts)
    write_whole(path, content)
    return [path]


def export_moves(dataset: Path, path: Path) -> list[Path]:
    """Write the moves of a sweep as C: a table, and what interpolates it.

    InfeasibleTaskError where moves between its cells break a limit.
    """
    from quietarm.studies.sweep.library import MoveLibrary

    library = MoveLibrary(dataset)
    between = library.between()
    if not between.keeps_limits:
        raise InfeasibleTaskError(
            f"moves between the cells of {dataset} break their limits by up to "
            f"{between.of_limits - 1:.1%}, and nothing was written; {between.remedy}"
        )
    return _write_c(library, path)


def _write_c(moves: Any, path: Path) -> list[Path]:
    """Write header and source, the header first."""
    from quietarm.studies.export.c_source import c_files

    files = [path.with_suffix(".h"), path]
    for file, content in zip(files, c_files(moves, path.stem), strict=True):
        write_whole(file, content)
    return files
