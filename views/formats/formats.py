"""The formats that moves are exported in, and what writes each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quietarm.ocp import Plan
from quietarm.ocp.checks import positive
from quietarm.ocp.files import write_together, write_whole
from quietarm.views.formats.move_tables import csv_text, mat_bytes, ros_text

COLUMNS = "time,angle,speed,acceleration"
RATE = 1000.0
FRAMES = 25.0
JOINT = "joint"
WIDTHS = 200, 2000
"""Least and largest width of a film [pixels]."""
_FILM = ("speed", "deflection_scale", "width", "rate")
_PAGE = ("deflection_scale",)


@dataclass(frozen=True)
class Format:
    """The endings of a format's files, and what of `export` it takes.

    `content` is (plan, what it takes) -> text or bytes; None of C, which has two files, of films
    and of the page.
    `to_stdout` is whether it can go to standard output: a single text.
    """

    endings: tuple[str, ...]
    takes: tuple[str, ...] = ()
    content: Callable[..., str | bytes] | None = None
    to_stdout: bool = False

    @property
    def is_film(self) -> bool:
        """Whether it shows the structure in motion."""
        return self.takes == _FILM

    @property
    def is_page(self) -> bool:
        """Whether it is the page on which one drags along a front."""
        return self.takes == _PAGE


FORMATS = {
    "csv": Format((".csv",), ("columns", "rate"), csv_text, to_stdout=True),
    "c": Format((".c",)),
    "ros": Format((".yaml", ".yml"), ("rate", "joint"), ros_text, to_stdout=True),
    "mat": Format((".mat",), ("columns", "rate"), mat_bytes),
    "gif": Format((".gif",), _FILM),
    "mp4": Format((".mp4",), _FILM),
    "html": Format((".html", ".htm"), _PAGE),
}


def format_of(path: Path) -> str:
    """The format of a file by the ending of its name; ValueError where there is none."""
    ending = path.suffix.lower()
    for name, form in FORMATS.items():
        if ending in form.endings:
            return name
    if ending == ".h":
        raise ValueError(f"{path} is written beside its C source; give {path.with_suffix('.c')}")
    known = ", ".join(ending for form in FORMATS.values() for ending in form.endings)
    raise ValueError(f"{path} does not say in which form it is; end its name in one of {known}")


def export_plan(
    plan: Plan, path: str | Path, *, columns: str = COLUMNS, rate: float = RATE, joint: str = JOINT
) -> list[Path]:
    """Write a plan in a form that a controller reads.

    Parameters
    ----------
    plan : Plan
        The move.
    path : str or Path
        The file: a table (.csv), C source (.c, with its header beside it), a JointTrajectory of
        ROS 2 (.yaml) or MATLAB v5 (.mat).
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
        When a name, a unit or a rate is out of range, or the file is a film or a page.
    """
    path = Path(path)
    name = format_of(path)
    if FORMATS[name].is_film:
        raise ValueError(f"{path} is a film; make it by animate(plan).save(path)")
    if FORMATS[name].is_page:
        raise ValueError(f"{path} is a page; make it by trade_off(plan).save(path)")
    if FORMATS[name].content is None:
        return write_c(plan, path)
    write_whole(path, content_of(plan, name, columns=columns, rate=rate, joint=joint))
    return [path]


def content_of(
    plan: Plan, name: str, *, columns: str = COLUMNS, rate: float = RATE, joint: str = JOINT
) -> str | bytes:
    """What the only file of a format holds; arguments as of `export_plan`."""
    form = FORMATS[name]
    assert form.content is not None
    settings = {"columns": columns, "rate": positive("sample rate", rate, "Hz"), "joint": joint}
    return form.content(plan, **{taken: settings[taken] for taken in form.takes})


def write_c(moves: Any, path: Path) -> list[Path]:
    """Write header and source, both or neither."""
    from quietarm.views.formats.c_source import c_files

    files = [path.with_suffix(".h"), path]
    write_together(dict(zip(files, c_files(moves, path.stem))))
    return files
