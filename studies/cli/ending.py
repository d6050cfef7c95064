"""The end of every command: save what was found, show it, then name the files written."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from quietarm.ocp import QuietarmError
from quietarm.ocp.files import unwritable
from quietarm.ocp.interrupts import note_interrupts
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import STDOUT, File
from quietarm.studies.display.words import print_lines
from quietarm.studies.document.blocks import Document
from quietarm.studies.document.terminal import show
from rich.console import Console

_OF_A_FILE = (OSError, ValueError, QuietarmError)


@dataclass(frozen=True)
class Together:
    """Files of a folder that are named together: '8 fronts to fronts'."""

    what: str
    folder: Path
    files: Sequence[File]


@dataclass
class _Saved:
    written: list[str] = field(default_factory=list)
    failures: list[Exception] = field(default_factory=list)

    def save(self, files: Iterable[File]) -> list[str]:
        """Save files, each even if another fails; returns the names of those written."""
        names: list[str] = []
        for path, write in files:
            if path is not None:
                try:
                    _save(path, write)
                except Exception as error:  # of any kind: the next file may be saved all the same
                    self.failures.append(_named(path, error))
                else:
                    names += [] if path is STDOUT else [str(path)]
        return names


def finish(
    files: Sequence[File],
    document: Document,
    *,
    trouble: Exception | None = None,
    together: Together | None = None,
    quiet: bool = True,
) -> None:
    """Save every file that was asked for, show what was found, and say what was written.

    In this order, so that nothing is lost where standard output is closed. Ctrl-C waits until the
    files are there. Words go to standard error where standard output is one of the files.
    """
    saved = _Saved()
    with note_interrupts() as came, working("writing", Console(stderr=True), quiet=quiet):
        saved.written += saved.save(files)
        if together is not None:
            names = saved.save(together.files)
            saved.written += [f"{len(names)} {together.what} to {together.folder}"] * bool(names)
    try:
        console = Console(stderr=any(path is STDOUT for path, _ in files))
        show(console, document)
        for name in saved.written:
            print_lines(console, f"wrote {name}")
    except KeyboardInterrupt:
        came.append(0)
    _raise(saved, trouble, interrupted=bool(came))


def interruption(after: str | None = None) -> QuietarmError:
    """The error to raise after Ctrl-C, which says how much of the work was done."""
    when = f" after {after}" if after else ""
    return QuietarmError(f"interrupted{when}; what was found until then is kept")


def _save(path: Path, write: Callable[[Path], object]) -> None:
    if path is not STDOUT:
        write(path)
        return
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        whole = Path(folder) / "output"
        write(whole)
        sys.stdout.write(whole.read_text(encoding="utf-8"))


def _named(path: Path, error: Exception) -> Exception:
    """The same error, with the name of the file where the system's own leaves it out."""
    if isinstance(error, OSError):
        return unwritable(path, error)
    return error


def _raise(saved: _Saved, trouble: Exception | None, interrupted: bool) -> None:
    for error in saved.failures:
        if not isinstance(error, _OF_A_FILE):
            raise error
    if interrupted and trouble is None:
        if not saved.written and not saved.failures:
            raise KeyboardInterrupt
        kept = f"wrote {', '.join(saved.written)}" if saved.written else "nothing was written"
        trouble = QuietarmError(f"interrupted; {kept}")
    if saved.failures:
        first, *others = saved.failures
        more = [f"nor can {len(others)} other file{'s' * (len(others) > 1)}"] if others else []
        raise ValueError("; ".join([*([str(trouble)] if trouble else []), str(first), *more]))
    if trouble is not None:
        raise trouble
