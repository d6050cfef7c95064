"""Read answers from files: a front, whose figures are checked against the plant; plans."""

from __future__ import annotations

import json
from codecs import BOM_UTF8
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import msgspec

from quietarm.metaheuristics.evaluation.stated_figures import check_figures, check_plan
from quietarm.ocp import FileFormatError, Front, Plan
from quietarm.ocp.files import read_bytes


def format_of(path: Path) -> str:
    """The format that a file states; empty where it states none, for its reader to refuse."""
    # a file that cannot be read, is no JSON, or is nested too deep
    with suppress(FileFormatError, ValueError, RecursionError):
        content = read_bytes(path).removeprefix(BOM_UTF8)
        with suppress(msgspec.DecodeError):
            return msgspec.json.decode(content, type=_Format).format
        document = json.loads(content)  # with NaN, as Python writes it
        stated = document.get("format") if isinstance(document, dict) else ""
        return stated if isinstance(stated, str) else ""
    return ""


class _Format(msgspec.Struct):
    """The entry of a file's format, among any others."""

    format: str = ""


def load_front(path: Path) -> Front:
    """The front of a file, after some of its motions were evaluated again."""
    if not path.exists() and (seeds := sorted(path.parent.glob(f"{path.stem}-seed*.json"))):
        raise FileFormatError(
            f"{path} is no file; --runs has written a front for each seed: give {seeds[0].name} "
            "and the others"
        )
    front = Front.load(path)
    if not front.points:
        raise ValueError(f"{path}: {front.why_empty()}")
    check_figures(front, str(path))
    return front


def load_runs(paths: Sequence[Path]) -> tuple[dict[Path, Front], list[str]]:
    """Recorded runs, of files or of all files of folders, after their motions were evaluated again.

    And words on files of a folder that are no runs, or damaged. Unlike a front, a run may have
    found nothing.
    """
    inside = [sorted(path.rglob("*.json")) if path.is_dir() else [path] for path in paths]
    files = [file for in_folder in inside for file in in_folder]
    for file in files:
        if files.count(file) > 1:
            raise ValueError(f"the run {file} is given twice; give it once")
    runs = dict[Path, Front]()
    left_out = list[str]()
    for file in files:
        try:
            runs[file] = Front.load(file)
        except FileFormatError as error:
            if file in paths:  # asked for by its own name
                raise
            left_out.append(f"{error}: left out")
    for file, run in runs.items():
        check_figures(run, str(file))
    return runs, left_out


def load_plans(paths: Sequence[Path]) -> dict[str, Plan]:
    """Plans from their files, after their motions were evaluated again."""
    return {name: _load_plan(path) for name, path in _named(paths, "plan").items()}


def load_fronts_and_plans(paths: Sequence[Path]) -> dict[str, Front | Plan]:
    """Fronts and plans from their files, after their motions were evaluated again."""
    return {
        name: load_front(path) if format_of(path) == f"quietarm-{Front.kind}" else _load_plan(path)
        for name, path in _named(paths, "plan or front").items()
    }


def _named(paths: Sequence[Path], what: str) -> dict[str, Path]:
    """Files by the names that pictures call them by, which differ."""
    if not paths:
        command = "quietarm plan" if what == "plan" else "quietarm plan or front"
        raise ValueError(f"no {what} is given; give files that were written by {command} --output")
    for path in paths:
        if list(paths).count(path) > 1:
            raise ValueError(f"{path} is given twice; give it once")
    stems = [path.stem for path in paths]
    names = stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
    return dict(zip(names, paths))


def _load_plan(path: Path) -> Plan:
    plan = Plan.load(path)
    check_plan(plan, path)
    return plan
