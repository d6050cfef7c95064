"""The files that a command writes, and its end: save what was found, show it, name the files."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console

from quietarm.interrupts import note_interrupts
from quietarm.ocp import Plan, QuietarmError
from quietarm.ocp.files import check_writable, unwritable
from quietarm.ocp.objectives import refuse_peaks
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import busy, option
from quietarm.studies.cli.types import Parsed
from quietarm.views.report.saving import STDOUT, SUFFIXES, File, drawing
from quietarm.views.report.terminal import show_all

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from quietarm.views.report import Report

PICTURE = SUFFIXES[0]
PAGE = ".html"
FOLDER = ""
DATASET = ".zarr"
TRAJECTORY = ".yaml"


def output_option(kinds: Mapping[str, str], *, required: bool = False) -> click.Option:
    """--output, which may be repeated, and what the files of each ending hold.

    A command whose answers go to standard output as well has the ending .json.
    """
    names = {PICTURE: ", ".join(SUFFIXES), FOLDER: "a folder", DATASET: "a folder NAME.zarr"}
    listed = "; ".join(f"{names.get(kind, kind)} for {words}" for kind, words in kinds.items())

    def check(text: str) -> Path:
        path = Path(text)
        kind = ending_of(path)
        if path == STDOUT:
            if ".json" not in kinds:
                raise ValueError(f"this cannot go to standard output; give a name, or ./{text}")
            return path
        if kind not in kinds:
            raise ValueError(f"{text} is none of the files that it writes; give {listed}")
        return check_folder(path) if kind in (FOLDER, DATASET) else check_writable(path)

    return option(
        "--output", "-o", type=Parsed("file", check), multiple=True, required=required,
        help=f"File to write, by its ending: {listed}.",
    )  # fmt: skip


REPORT_OPTION = output_option(
    {FOLDER: "Markdown, CSV and pictures", ".html": "a page", ".tex": "the tables"}
)


def check_folder(path: str | Path) -> Path:
    """Make sure before the work that files can be written in a folder, or that it can be made."""
    folder = Path(path)
    if folder == STDOUT:
        raise ValueError(f"this cannot go to standard output; give a name, or ./{folder}")
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give a folder")
    check_writable(folder / "any" if folder.is_dir() else folder)
    return folder


def ending_of(path: Path) -> str:
    """The ending that says what goes into a file; that of JSON for standard output."""
    if path == STDOUT:
        return ".json"
    same = {**dict.fromkeys(SUFFIXES, PICTURE), ".htm": ".html", ".txt": ".csv"}
    suffix = path.suffix.lower()
    return same.get(suffix, suffix)


def answer_files(
    output: Sequence[Path],
    draw: Callable[[], Figure],
    answer: Any = None,
    beside: Sequence[Any] = (),
) -> list[File]:
    """An answer as JSON, as a table where it has one, and as a picture, as the endings say.

    And as a page, on which further answers lie beside it.
    """
    saves = {".json": "save", ".csv": "save_csv"}
    ways = {ending: getattr(answer, save, None) for ending, save in saves.items()}
    ways[TRAJECTORY] = partial(_save_trajectory, answer)
    ways[PAGE] = partial(_save_page, [answer, *beside])
    return [(path, ways.get(ending_of(path)) or drawing(draw)) for path in output]


def check_page(output: Sequence[Path], objectives: Sequence[str]) -> None:
    """Refuse a page of a front that has peaks among its objectives, before it is found."""
    if PAGE in map(ending_of, output):
        refuse_peaks("the front", objectives)


def _save_trajectory(plan: Plan, path: Path) -> None:
    """As a controller of ROS 2 reads it."""
    from quietarm.views.formats.formats import export_plan

    export_plan(plan, path)


def _save_page(answers: Sequence[Any], path: Path) -> None:
    """To drag along a front, or to see a plan move."""
    from quietarm.studies.reproduce.paper import paper_points
    from quietarm.views.page.trade_off import trade_off

    trade_off(answers, known_points=paper_points).save(path)


def finish(
    files: Sequence[File],
    *shown: Report | Sequence[tuple[str, str]] | str,
    trouble: Exception | None = None,
) -> None:
    """Save every file that was asked for, show what was found, and say what was written.

    In this order, so that nothing is lost where standard output is closed. Ctrl-C waits until the
    files are there. Words go to standard error where standard output is one of the files.
    """
    written = list[str]()
    failures = list[Exception]()
    with note_interrupts() as came, busy("writing"):
        for path, write in files:
            try:
                _save(path, write)
            except OSError as error:  # the system's own may leave the name out
                place = Path("standard output") if path == STDOUT else path
                failures.append(unwritable(place, error))
            except Exception as error:  # of any kind: the next file may be saved all the same
                failures.append(error)
            else:
                written += [] if path == STDOUT else [str(path)]
    if came and trouble is None:
        words = f"interrupted; wrote {', '.join(written) or 'nothing'}"
        trouble = InterruptedCommandError(words, came[0])
    error = _error_of_all([*([trouble] if trouble else []), *failures])
    console = Console(stderr=STDOUT in dict(files))
    show_all(console, *shown, *(f"wrote {name}" for name in written))
    if error is not None:
        raise error


def _error_of_all(errors: Sequence[Exception]) -> Exception | None:
    """The error that has no words for the user, or the only one, or one with the words of all."""
    for error in errors:
        if not isinstance(error, ValueError | QuietarmError) or len(errors) == 1:
            return error
    return ValueError("; ".join(map(str, errors))) if errors else None


def _save(path: Path, write: Callable[[Path], object]) -> None:
    if path != STDOUT:
        write(path)
        return
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        whole = Path(folder) / "output"
        write(whole)
        sys.stdout.write(whole.read_text(encoding="utf-8"))
