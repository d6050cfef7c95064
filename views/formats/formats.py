"""Write answers in a format, by the ending of a file's name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from quietarm.interrupts import interruptible
from quietarm.ocp import Front, Plan
from quietarm.ocp.checks import name_of_file
from quietarm.ocp.files import write_together
from quietarm.views.formats.export_format import (
    Answers,
    ExportFormat,
    Progress,
    format_of,
    values_of,
)


@interruptible
def export_plan(
    plan: Plan | Front | Mapping[str, Plan | Front], path: str | Path, **settings: Any
) -> list[Path]:
    """Write a plan in a form that a controller, or a person, reads.

    Parameters
    ----------
    plan : Plan, Front or mapping
        The move. A page takes a front as well; pages and films take several by what they are
        called.
    path : str or Path
        The file, whose ending is the format: that of an `ExportFormat`, quietarm's or your own.
        `quietarm export --help` and the page "Plan a move" list all.
    **settings : Any
        Settings of the format by name, such as ``rate=500`` and ``columns="time:ms,angle:deg"``:
        the options of `quietarm export` without their hyphens.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ValueError
        When a name, a unit, a rate or a setting is out of range, or the format has no such setting.
    """
    name_of_file(path)
    path = Path(path)
    answers = plan if isinstance(plan, Mapping) else [plan]
    return write_in(format_of(path), answers, path, settings)[0]


def write_in(
    form: ExportFormat,
    answers: Answers,
    path: Path,
    settings: Mapping[str, Any] | None = None,
    report: Progress | None = None,
) -> tuple[list[Path], list[str]]:
    """Write answers in a format, all files or none; what was written, and what is said of it."""
    made = form.make(answers, path, settings or {}, report)
    write_together({**made.files})
    notes = [*made.notes, *_drive_notes(form, answers)]
    return [*made.files], [note for note in notes if note]


def _drive_notes(form: ExportFormat, answers: Answers) -> list[str]:
    """Say that a format has the load's path of a plan whose set points go through a drive."""
    plans = [answer for answer in values_of(answers) if isinstance(answer, Plan)]
    if form.of_the_load and any(plan.candidate.inverts_drive for plan in plans):
        return [
            f"{form.name}: the load's path, without the drive; tables (.csv), messages of ROS and "
            "records of CiA 402 have the set points through the drive"
        ]
    return []
