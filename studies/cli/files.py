"""The files that a command writes: --output, whose ending says what goes into each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from quietarm.ocp.files import check_writable, write_whole
from quietarm.studies.cli.folders import check_folder
from quietarm.studies.cli.types import Parsed
from quietarm.studies.report.pictures import SUFFIXES
from quietarm.studies.report.saving import STDOUT, File

if TYPE_CHECKING:
    from quietarm.studies.report import Report

F = TypeVar("F", bound=Callable[..., Any])
Write = Callable[[Path], object]
PICTURE, FOLDER, DATASET = SUFFIXES[0], "", ".zarr"
_SAME = {**dict.fromkeys(SUFFIXES, PICTURE), ".htm": ".html", ".txt": ".csv"}
"""Endings that mean the same as another."""


def output_option(kinds: Mapping[str, str], *, required: bool = False) -> Callable[[F], F]:
    """--output, which may be repeated, and what the files of each ending hold.

    A command whose answers go to standard output as well has the ending .json.
    """

    def check(text: str) -> Path:
        if text == str(STDOUT):
            if ".json" in kinds:
                return STDOUT
            raise ValueError(f"this cannot go to standard output; give a name, or ./{text}")
        path, kind = Path(text), ending_of(Path(text))
        if kind not in kinds:
            raise ValueError(f"{text} is none of the files that it writes; give {listed}")
        return check_folder(path) if kind in (FOLDER, DATASET) else check_writable(path)

    names = {PICTURE: ", ".join(SUFFIXES), FOLDER: "a folder", DATASET: "a folder NAME.zarr"}
    listed = "; ".join(f"{names.get(kind, kind)} for {words}" for kind, words in kinds.items())
    return click.option(
        "--output", type=Parsed("file", check), multiple=True, required=required,
        help=f"File to write, by its ending: {listed}. May be repeated.",
    )  # fmt: skip


def ending_of(path: Path) -> str:
    """The ending that says what goes into a file; that of JSON for standard output."""
    return ".json" if path == STDOUT else _SAME.get(path.suffix.lower(), path.suffix.lower())


def files_of(output: Sequence[Path], writes: Mapping[str, Write]) -> list[File]:
    """The files that were asked for, and what writes each by its ending."""
    return [(path, writes[ending_of(path)]) for path in output]


def report_files(output: Sequence[Path], report: Report) -> list[File]:
    """A report as a folder, a page, Markdown or LaTeX, as the endings say."""
    writes: dict[str, Callable[[], str]] = {
        ".html": report.html, ".md": report.markdown, ".tex": report.latex,
    }  # fmt: skip
    found = list[File]()
    for path in output:
        if ending_of(path) == FOLDER:
            found += report.files(path)
        else:
            text = writes[ending_of(path)]
            found.append((path, lambda place, text=text: write_whole(place, text())))
    return found


def refuse_same_file(values: Mapping[str, Any]) -> None:
    """Refuse a line that names one file twice, so that nothing that is read is written over."""
    known = set[str]()
    for value in values.values():
        for path in value if isinstance(value, tuple | list) else [value]:
            if not isinstance(path, Path) or path == STDOUT:
                continue
            place = os.path.realpath(path)  # of a link, too
            if place in known:
                raise ValueError(f"{path} is given twice; give it once, or another name")
            known.add(place)
