"""Files and folders of answers to compare: plans, or fronts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from quietarm.ocp import FileFormatError, Front, Plan
from quietarm.studies.answers.read_answers import format_of, load_front, load_plans

_FRONT = f"quietarm-{Front.kind}"
_PLAN = f"quietarm-{Plan.kind}"


def open_answers(paths: Sequence[Path]) -> dict[str, Plan] | dict[str, Front]:
    """Plans or fronts by their names; of a folder the fronts in it, as those of a bench.

    ValueError where there are none, or of both; every file's figures are checked.
    """
    if not paths:
        raise ValueError("nothing is given to compare; give plans, fronts, or a folder of fronts")
    kinds = {path: format_of(path) for typed in paths for path in _files(typed)}
    fronts = [path for path, kind in kinds.items() if kind == _FRONT]
    plans = [path for path, kind in kinds.items() if kind == _PLAN]
    if plans and fronts:
        raise ValueError(
            f"{fronts[0]} is a front and {plans[0]} a plan; compare fronts or plans, not both"
        )
    if plans:
        return load_plans([path for path in paths if not path.is_dir()])
    files = [path for path in paths if not path.is_dir()]
    for path in files:
        if files.count(path) > 1:
            raise ValueError(f"{path} is given twice; give it once")
    return {str(path): load_front(path) for path in kinds}


def _files(path: Path) -> Iterator[Path]:
    """A file itself; of a folder the fronts below it."""
    if not path.is_dir():
        yield path
        return
    fronts = [file for file in sorted(path.rglob("*.json")) if format_of(file) == _FRONT]
    if not fronts:
        raise FileFormatError(f"{path} holds no fronts; give a folder of a bench, or files")
    yield from fronts
