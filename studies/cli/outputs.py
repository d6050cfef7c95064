"""The files that a command writes, and its end: save what was found, show it, name the files."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
from rich.console import Console

from quietarm.interrupts import note_interrupts
from quietarm.ocp import Plan, QuietarmError
from quietarm.ocp.files import check_writable, unwritable
from quietarm.ocp.objectives import refuse_peaks
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import busy, option
from quietarm.studies.cli.types import Parsed
from quietarm.views.formats.export_format import SEVERAL, ExportFormat, format_of, formats_of
from quietarm.views.formats.formats import write_in
from quietarm.views.report.saving import STDOUT, SUFFIXES, File, drawing
from quietarm.views.report.terminal import show_all

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from quietarm.views.report import Report

PICTURE = SUFFIXES[0]
PAGE = ".html"
FOLDER = ""
DATASET = ".zarr"


class Written(NamedTuple):
    """The files that were written, and what is said of them."""

    paths: Sequence[Path]
    notes: Sequence[str] = ()


_NAMES = {PICTURE: ", ".join(SUFFIXES), FOLDER: "a folder", DATASET: "a folder NAME.zarr"}


def output_option(
    kinds: Mapping[str, str], *, formats: Sequence[str] = (), required: bool = False
) -> click.Option:
    """--output, which may be repeated, and what the files of each ending hold.

    Besides these it takes every format of plans, or of fronts, as `formats` has it. A command whose
    answers go to standard output as well has the ending .json.
    """

    def check(text: str) -> Path:
        path = Path(text)
        kind = ending_of(path)
        if path == STDOUT:
            if ".json" not in kinds:
                raise ValueError(f"this cannot go to standard output; give a name, or ./{text}")
            return path
        if kind not in kinds:
            _check_format(path, kinds, formats)
        return check_folder(path) if kind in (FOLDER, DATASET) else check_writable(path)

    return option(
        "--output", "-o", type=Parsed("file", check), multiple=True, required=required,
        help=f"File to write, by its ending: {_listed(kinds, formats)}.",
    )  # fmt: skip


def _check_format(path: Path, kinds: Mapping[str, str], formats: Sequence[str]) -> None:
    """Refuse a file that is of no format of such answers, or whose name that has no use for."""
    for form in formats_of(*formats):
        if path.suffix.lower() in form.endings:
            return form.check_path(path)
        if path.suffix.lower() in form.beside:
            format_of(path)  # which says what it stands beside
    further = [form.endings[0] for form in formats_of(*formats) if form.endings[0] not in kinds]
    also = f"; or {', '.join(further)}" if further else ""
    raise ValueError(f"cannot write {path}: give {_listed(kinds, ())}{also}")


def _listed(kinds: Mapping[str, str], formats: Sequence[str]) -> str:
    """List the files that a command writes: its own kinds, and the formats."""
    words = [f"{_NAMES.get(kind, kind)} for {meaning}" for kind, meaning in kinds.items()]
    by_meaning = dict[str, list[str]]()
    for form in formats_of(*formats):
        if form.endings[0] not in kinds:
            by_meaning.setdefault(form.meaning, []).append(form.endings[0])
    words += [f"{', '.join(endings)} for {meaning}" for meaning, endings in by_meaning.items()]
    return "; ".join(words)


def refuse_formats(output: Sequence[Path], but: Sequence[str], answers: str) -> None:
    """Refuse files of formats that do not take what is found after all, a plan or a front."""
    for path in output:
        written = ending_of(path) in but
        if not written and all(path.suffix.lower() not in f.endings for f in formats_of(answers)):
            known = [_NAMES.get(kind, kind) for kind in but]
            known += [form.endings[0] for form in formats_of(answers)]
            raise ValueError(f"{path} cannot hold a {answers}; give {', '.join(known)}")


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
    same = {**dict.fromkeys(SUFFIXES, PICTURE), ".htm": PAGE, ".txt": ".csv"}
    suffix = path.suffix.lower()
    return same.get(suffix, suffix)


def answer_files(
    output: Sequence[Path],
    draw: Callable[[], Figure],
    answer: Any = None,
    beside: Sequence[Any] = (),
) -> list[File]:
    """An answer as JSON, as a table where it has one, as a picture, or in a format, by the ending.

    The table of a plan is a format; a front has one of its own. In a format that takes several,
    further answers lie beside it.
    """
    saves = {".json": "save"} if isinstance(answer, Plan) else {".json": "save", ".csv": "save_csv"}
    files = list[File]()
    for path in output:
        ending = ending_of(path)
        save = getattr(answer, saves.get(ending, ""), None)
        if save is None:
            drawn = answer is None or ending in (PICTURE, *saves)
            save = drawing(draw) if drawn else _exporting(answer, beside)
        files.append((path, save))
    return files


def _exporting(answer: Any, beside: Sequence[Any]) -> Callable[[Path], Written]:
    """Return the function that writes an answer in the format of a file's ending."""

    def write(path: Path) -> Written:
        form = format_of(path.with_suffix(ending_of(path)))  # a .txt is a csv
        together = [answer, *(beside if SEVERAL in form.takes else ())]
        return Written(*write_in(form, together, path, settings_of_studies(form)))

    return write


def settings_of_studies(form: ExportFormat) -> dict[str, Any]:
    """Return the settings that a page gets from studies: the points that the paper states."""
    if all(setting.name != "known_points" for setting in form.settings):
        return {}
    from quietarm.studies.reproduce.paper import paper_points

    return {"known_points": paper_points}


def check_page(output: Sequence[Path], objectives: Sequence[str]) -> None:
    """Refuse a page of a front that has peaks among its objectives, before it is found."""
    if PAGE in map(ending_of, output):
        refuse_peaks("the front", objectives)


def finish(
    files: Sequence[File],
    *shown: Report | Sequence[tuple[str, str]] | str,
    trouble: BaseException | None = None,
) -> None:
    """Save every file that was asked for, show what was found, and say what was written.

    In this order, so that nothing is lost where standard output is closed. Ctrl-C waits until the
    files are there. Words go to standard error where standard output is one of the files.
    """
    written = list[str]()
    notes = list[str]()
    failures = list[BaseException]()
    with note_interrupts() as came, busy("writing"):
        for path, write in files:
            try:
                made = _save(path, write)
            except OSError as error:  # the system's own may leave the name out
                place = Path("standard output") if path == STDOUT else path
                failures.append(unwritable(place, error))
            except Exception as error:  # of any kind: the next file may be saved all the same
                failures.append(error)
            else:
                if not isinstance(made, Written):
                    made = Written([] if path == STDOUT else [path])
                notes += [f"{path}: {note}" for note in made.notes]
                written += map(str, made.paths)
    if came and trouble is None:
        words = f"interrupted; wrote {', '.join(written) or 'nothing'}"
        trouble = InterruptedCommandError(words, came[0])
    error = _error_of_all([*([trouble] if trouble else []), *failures])
    console = Console(stderr=STDOUT in dict(files))
    show_all(console, *shown, *notes, *(f"wrote {name}" for name in written))
    if error is not None:
        raise error


def _error_of_all(errors: Sequence[BaseException]) -> BaseException | None:
    """The error that has no words for the user, or the only one, or one with the words of all."""
    for error in errors:
        if not isinstance(error, ValueError | QuietarmError) or len(errors) == 1:
            return error
    return ValueError("; ".join(map(str, errors))) if errors else None


def _save(path: Path, write: Callable[[Path], object]) -> object:
    if path != STDOUT:
        return write(path)
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        whole = Path(folder) / "output"
        write(whole)
        sys.stdout.write(whole.read_text(encoding="utf-8"))
    return None
