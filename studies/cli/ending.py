"""The end of every command: save what was found, show it, then name the files written."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.ocp import QuietarmError
from quietarm.ocp.files import unwritable
from quietarm.ocp.interrupts import note_interrupts
from quietarm.studies.cli.options import quiet
from quietarm.studies.report.progress import working
from quietarm.studies.report.saving import STDOUT, File
from quietarm.studies.report.terminal import show, show_facts
from quietarm.studies.report.words import print_lines
from rich.console import Console

if TYPE_CHECKING:
    from quietarm.studies.report import Report

Facts = Sequence[tuple[str, str]]
"""Names and their values, one below the other."""


@dataclass(frozen=True)
class Together:
    """Files of a folder that are named together: '8 fronts to fronts'."""

    what: str
    folder: Path
    files: Sequence[File]


def finish(
    files: Sequence[File],
    *shown: Report | Facts | str,
    trouble: Exception | None = None,
    together: Together | None = None,
) -> None:
    """Save every file that was asked for, show what was found, and say what was written.

    In this order, so that nothing is lost where standard output is closed. Ctrl-C waits until the
    files are there. Words go to standard error where standard output is one of the files.
    """
    failures = list[Exception]()
    with note_interrupts() as came, working("writing", Console(stderr=True), quiet=quiet()):
        written = [str(path) for path in _saved(files, failures) if path is not STDOUT]
        if together is not None and (inside := _saved(together.files, failures)):
            written.append(f"{len(inside)} {together.what} to {together.folder}")
    try:
        console = Console(stderr=any(path is STDOUT for path, _ in files))
        for part in filter(None, shown):
            _show(console, part)
        for name in written:
            print_lines(console, f"wrote {name}")
    except KeyboardInterrupt:
        came.append(0)
    if came and trouble is None:
        if not written and not failures:
            raise KeyboardInterrupt
        kept = f"wrote {', '.join(written)}" if written else "nothing was written"
        trouble = QuietarmError(f"interrupted; {kept}")
    _raise(failures, trouble)


def _show(console: Console, part: Report | Facts | str) -> None:
    if isinstance(part, str):
        print_lines(console, part)
    elif isinstance(part, Sequence):
        show_facts(console, part)
    else:
        show(console, part)


def interruption(after: str | None = None) -> QuietarmError:
    """The error to raise after Ctrl-C, which says how much of the work was done."""
    when = f" after {after}" if after else ""
    return QuietarmError(f"interrupted{when}; what was found until then is kept")


def _saved(files: Iterable[File], failures: list[Exception]) -> list[Path]:
    """Save files, each even if another fails; the paths of those written."""
    paths = list[Path]()
    for path, write in files:
        if path is not None:
            try:
                _save(path, write)
                paths.append(path)
            except OSError as error:  # the system's own may leave the name out
                failures.append(unwritable(path, error))
            except Exception as error:  # of any kind: the next file may be saved all the same
                failures.append(error)
    return paths


def _save(path: Path, write: Callable[[Path], object]) -> None:
    if path is not STDOUT:
        write(path)
        return
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        whole = Path(folder) / "output"
        write(whole)
        sys.stdout.write(whole.read_text(encoding="utf-8"))


def _raise(failures: Sequence[Exception], trouble: Exception | None) -> None:
    for error in failures:
        if not isinstance(error, ValueError | QuietarmError):
            raise error
    if failures:
        first, *others = failures
        more = [f"nor can {len(others)} other file{'s' * (len(others) > 1)}"] * bool(others)
        raise ValueError("; ".join([*([str(trouble)] if trouble else []), str(first), *more]))
    if trouble is not None:
        raise trouble
