"""The files that a command writes, and its end: save what was found, show it, name the files."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from quietarm.ocp import Front, QuietarmError
from quietarm.ocp.files import check_writable, unwritable, write_whole
from quietarm.ocp.interrupts import note_interrupts
from quietarm.studies.cli.options import busy, option
from quietarm.studies.cli.types import Parsed
from quietarm.studies.report.pictures import SUFFIXES
from quietarm.studies.report.saving import STDOUT, File, drawing
from quietarm.studies.report.terminal import show, show_facts
from quietarm.studies.report.words import print_lines
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from quietarm.studies.report import Report

F = TypeVar("F", bound=Callable[..., Any])
PICTURE, FOLDER, DATASET = SUFFIXES[0], "", ".zarr"
_SAME = {**dict.fromkeys(SUFFIXES, PICTURE), ".htm": ".html", ".txt": ".csv"}
"""Endings that mean the same as another."""


def output_option(kinds: Mapping[str, str], *, required: bool = False) -> Callable[[F], F]:
    """--output, which may be repeated, and what the files of each ending hold.

    A command whose answers go to standard output as well has the ending .json.
    """

    def check(text: str) -> Path:
        path, kind = Path(text), ending_of(Path(text))
        if path == STDOUT and ".json" not in kinds:
            raise ValueError(f"this cannot go to standard output; give a name, or ./{text}")
        if kind not in kinds:
            raise ValueError(f"{text} is none of the files that it writes; give {listed}")
        if path == STDOUT:
            return path
        return check_folder(path) if kind in (FOLDER, DATASET) else check_writable(path)

    names = {PICTURE: ", ".join(SUFFIXES), FOLDER: "a folder", DATASET: "a folder NAME.zarr"}
    listed = "; ".join(f"{names.get(kind, kind)} for {words}" for kind, words in kinds.items())
    return option(
        "--output", type=Parsed("file", check), multiple=True, required=required,
        help=f"File to write, by its ending: {listed}. May be repeated.",
    )  # fmt: skip


def check_folder(path: str | Path) -> Path:
    """Make sure before the work that files can be written in a folder, or that it can be made."""
    folder = Path(path)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give a folder")
    check_writable(folder / "any" if folder.is_dir() else folder)
    return folder


def ending_of(path: Path) -> str:
    """The ending that says what goes into a file; that of JSON for standard output."""
    return ".json" if path == STDOUT else _SAME.get(path.suffix.lower(), path.suffix.lower())


def files_of(output: Sequence[Path], writes: Mapping[str, Callable[..., Any]]) -> list[File]:
    """The files that were asked for, and what writes each by its ending, or draws a picture."""
    ways = {**writes, **({PICTURE: drawing(writes[PICTURE])} if PICTURE in writes else {})}
    return [(path, ways[ending_of(path)]) for path in output]


def front_files(output: Sequence[Path], front: Front, draw: Callable[[], Figure]) -> list[File]:
    """A front as JSON, its points as a table, and a picture."""
    return files_of(output, {".json": front.save, ".csv": front.save_csv, PICTURE: draw})


def report_files(output: Sequence[Path], report: Report) -> list[File]:
    """A report as a folder, a page, Markdown or LaTeX, as the endings say."""
    writes = {".html": report.html, ".md": report.markdown, ".tex": report.latex}
    found = list[File]()
    for path in output:
        if text := writes.get(ending_of(path)):
            found.append((path, lambda place, text=text: write_whole(place, text())))
        else:
            found += report.files(path)
    return found


def finish(
    files: Sequence[File],
    *shown: Report | Sequence[tuple[str, str]] | str,
    trouble: Exception | None = None,
) -> None:
    """Save every file that was asked for, show what was found, and say what was written.

    In this order, so that nothing is lost where standard output is closed. Ctrl-C waits until the
    files are there. Words go to standard error where standard output is one of the files.
    """
    written, failures = list[str](), list[Exception]()
    with note_interrupts() as came, busy("writing"):
        for path, write in files:
            try:
                _save(path, write)
                if path != STDOUT:
                    written.append(str(path))
            except OSError as error:  # the system's own may leave the name out
                failures.append(unwritable(path, error))
            except Exception as error:  # of any kind: the next file may be saved all the same
                failures.append(error)
    try:
        console = Console(stderr=any(path == STDOUT for path, _ in files))
        for part in filter(None, shown):
            if isinstance(part, str):
                print_lines(console, part)
            elif isinstance(part, Sequence):
                show_facts(console, part)
            else:
                show(console, part)
        for name in written:
            print_lines(console, f"wrote {name}")
    except KeyboardInterrupt:
        came.append(0)
    if came and trouble is None:
        if not (written or failures):
            raise KeyboardInterrupt
        names = ", ".join(written)
        trouble = QuietarmError(f"interrupted; {f'wrote {names}' if names else 'nothing written'}")
    for error in failures:
        if not isinstance(error, ValueError | QuietarmError):
            raise error
    if failures:
        raise ValueError("; ".join(map(str, filter(None, [trouble, *failures]))))
    if trouble is not None:
        raise trouble


def _save(path: Path, write: Callable[[Path], object]) -> None:
    if path != STDOUT:
        write(path)
        return
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        whole = Path(folder) / "output"
        write(whole)
        sys.stdout.write(whole.read_text(encoding="utf-8"))
