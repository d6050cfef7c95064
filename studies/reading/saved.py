"""What is read from files: a front, whose figures are checked against the plant; plans."""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import msgspec
from quietarm.metaheuristics.objective.stated_figures import check_figures, check_plan
from quietarm.ocp import FileFormatError, Front, Plan
from quietarm.ocp.files import read_bytes


def format_of(path: Path) -> str:
    """The format that a file states; empty where it states none, for its reader to refuse."""
    # a file that cannot be read, is no JSON, or is nested too deep
    with suppress(FileFormatError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        content = read_bytes(path).removeprefix(BOM_UTF8)
        return msgspec.json.decode(content, type=_Format).format
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


def load_runs(paths: Sequence[Path]) -> dict[Path, Front]:
    """Recorded runs, of files or of all files of folders, after their motions were evaluated again.

    Unlike a front, a run may have found nothing.
    """
    inside = [sorted(path.rglob("*.json")) if path.is_dir() else [path] for path in paths]
    files = [file for own in inside for file in own]
    for file in files:
        if files.count(file) > 1:
            raise ValueError(f"the run {file} is given twice; give it once")
    runs = {file: Front.load(file) for file in files}
    for file, run in runs.items():
        check_figures(run, str(file))
    return runs


def load_plans(paths: Sequence[Path]) -> dict[str, Plan]:
    """Plans from their files, after their motions were evaluated again."""
    if not paths:
        raise ValueError("no plan is given; give files that were written by quietarm plan --output")
    for path in paths:
        if list(paths).count(path) > 1:
            raise ValueError(f"{path} is given twice; give it once")
    stems = [path.stem for path in paths]
    names = stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
    plans = {name: Plan.load(path) for name, path in zip(names, paths)}
    for plan, path in zip(plans.values(), paths):
        check_plan(plan, str(path))
    return plans
