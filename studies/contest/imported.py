"""Results of other tools in a contest: a file of coefficients for each run, evaluated here."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from quietarm.metaheuristics import NamedProblem
from quietarm.ocp import SolverFailedError
from quietarm.ocp.answers.provenance import Setting
from quietarm.ocp.base.files import read_bytes
from quietarm.studies.contest.names import name_given
from quietarm.studies.contest.store import Run, Yardstick
from quietarm.studies.reading.foreign import read_found
from quietarm.studies.reading.importing import import_front


def named_files(texts: Sequence[str]) -> dict[str, list[Path]]:
    """Files of runs by the name of their method, of texts as ``name=path``."""
    found: dict[str, list[Path]] = {}
    for text in texts:
        name, equals, rest = text.partition("=")
        path = Path(text)
        if equals and rest and not path.exists():
            path = Path(rest)
        else:
            whole = path.resolve() if path.name in ("", "..") else path  # as . and /
            name = whole.name if whole.is_dir() else whole.stem
        if not path.exists():
            raise ValueError(f"there is no file or folder {path}; give one to --import")
        inside = [path]
        if path.is_dir():
            inside = sorted(p for p in path.iterdir() if p.is_file() and p.name[0] != ".")
        if not inside:
            raise ValueError(f"{path} has no files; give a folder with a file of each run")
        files = found.setdefault(name_given(name.strip()), [])
        for file in inside:
            if any(other.name == file.name for other in files):
                raise ValueError(f"{name} has two files {file.name}; rename one: each is a run")
            files.append(file)
    return found


def imported_run(
    problem: NamedProblem, yardstick: Yardstick, method: str, path: Path, evaluations: int | None
) -> Run:
    """Evaluate a file."""
    found = read_found(path)
    settings: dict[str, Setting] = {"imported": path.name, "bound": problem.bound}
    try:
        front, claims = import_front(problem.task, problem.profile, found, method, settings)
    except (ValueError, SolverFailedError) as error:
        raise type(error)(f"{path}: {error}") from None
    return Run(
        problem=problem.name,
        method=method,
        evaluations=evaluations,
        scale=yardstick.scale,
        front=front,
        file=path.name,
        digest=sha256(read_bytes(path)).hexdigest(),
        claims=tuple(claim.line() for claim in claims if claim.differ),
    )
