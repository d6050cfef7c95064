"""Results of other tools in a contest: a file of coefficients for each run, evaluated here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import ClassVar, NamedTuple

from quietarm.metaheuristics import NamedProblem
from quietarm.metaheuristics.budget.record import Scale
from quietarm.ocp import Front, SolverFailedError
from quietarm.ocp.answers.documents import read_bytes
from quietarm.ocp.answers.provenance import Setting
from quietarm.ocp.answers.saved import Saved
from quietarm.ocp.base.ranges import CountFromOne
from quietarm.studies.contest.names import name_given
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.reading.foreign import read_found
from quietarm.studies.reading.importing import import_front


class Source(NamedTuple):
    """What an imported run is kept under: problem, method and the name of its file."""

    problem: str
    method: str
    file: str


@dataclass(frozen=True)
class Imported(Saved):
    """One run of another tool on one problem; only what it ended with is known."""

    kind: ClassVar[str] = "contest-import"
    version: ClassVar[int] = 1

    problem: str
    method: str
    file: str
    digest: str
    evaluations: CountFromOne | None
    scale: Scale
    front: Front
    claims: tuple[str, ...] = ()

    @property
    def key(self) -> Source:
        """What it is kept under."""
        return Source(self.problem, self.method, self.file)

    @property
    def words(self) -> str:
        """Which run it is, in words."""
        return f"{self.file} of {self.method} on {self.problem}"


def named_files(texts: Sequence[str]) -> dict[str, list[Path]]:
    """Files of runs by the name of their method."""
    found: dict[str, list[Path]] = {}
    for text in texts:
        name, path = _named(text)
        files = found.setdefault(name, [])
        for file in _files(path):
            if any(other.name == file.name for other in files):
                raise ValueError(f"{name} has two files {file.name}; rename one: each is a run")
            files.append(file)
    return found


def _named(text: str) -> tuple[str, Path]:
    path = Path(text)
    name, equals, rest = text.partition("=")
    if not equals or path.exists():
        whole = path.resolve() if path.name in ("", "..") else path  # as . and /
        name = whole.stem if whole.suffix and not whole.is_dir() else whole.name
    elif not rest:
        raise ValueError(f"nothing follows {text}; give a file or folder to --import")
    else:
        path = Path(rest)
    if not path.exists():
        raise ValueError(f"there is no file or folder {path!s}; give one to --import")
    return name_given(name), path


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    files = sorted(p for p in path.iterdir() if p.is_file() and not p.name.startswith("."))
    if not files:
        raise ValueError(f"{path} has no files; give a folder with a file of coefficients a run")
    return files


def imported_run(
    problem: NamedProblem, yardstick: Yardstick, method: str, path: Path, evaluations: int | None
) -> Imported:
    """Evaluate a file."""
    found = read_found(path)
    columns, size = found.coefficients.shape[1], problem.profile.size
    if columns != size:
        raise ValueError(
            f"{path} has {columns} coefficients a motion, and {problem.name} takes {size}; give a "
            "file of that problem"
        )
    settings: dict[str, Setting] = {"imported": path.name, "bound": problem.bound}
    try:
        front, claims = import_front(problem.task, problem.profile, found, method, settings)
    except (ValueError, SolverFailedError) as error:
        raise type(error)(f"{path}: {error}") from None
    return Imported(
        problem=problem.name,
        method=method,
        file=path.name,
        digest=sha256(read_bytes(path)).hexdigest(),
        evaluations=evaluations,
        scale=yardstick.scale,
        front=front,
        claims=tuple(claim.line() for claim in claims if claim.differ),
    )
