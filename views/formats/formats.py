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
        The file, whose ending is the format: a table (.csv), C source (.c, with its header beside
        it), a JointTrajectory of ROS 2 (.yaml) or a RobotTrajectory of MoveIt (.moveit), MATLAB v5
        (.mat), a film (.gif, .mp4), a page (.html), or a format of one's own (`ExportFormat`).
    **settings : Any
        What the format may be told, by name. Of a table ``columns``, with units
        (``"time:ms,angle:deg,torque"``; a robust plan has a column ``tip`` for every scenario); of
        tables and trajectories ``rate``, rows in a second [Hz]; of a trajectory ``joint``, the
        joint's name, and ``thin``; of a film ``speed``, ``deflection_scale``, ``width`` and
        ``rate``; of a page ``deflection_scale``.

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
    return [*made.files], [note for note in made.notes if note]
