"""The runs of a contest: one file each in its folder, so that it goes on after any stop."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple, Self, TypeVar

from metaheuristics.budget.record import Mark, Scale, Visits
from metaheuristics.budget.run import BudgetRun
from ocp import FileFormatError, Front
from ocp.answers.saved import Saved
from ocp.base.ranges import CountFromOne
from studies.contest.landscape import Landscape
from studies.contest.problems import Yardstick

_YARDSTICKS, _RUNS, _LANDSCAPES = "exact", "runs", "landscape"
_Kind = TypeVar("_Kind", bound=Saved)


class Key(NamedTuple):
    """What a run is kept under."""

    problem: str
    method: str
    seed: int


@dataclass(frozen=True)
class Run(Saved):
    """One method on one problem from one seed.

    Attributes
    ----------
    problem, method : str
        Their names.
    budget : int
        Evaluations that it was given.
    population : int or None
        Individuals that were asked for; None where it has the method's own.
    scale : Scale
        Extent of the exact front that it was measured in.
    marks : tuple of Mark
        What it had found after so many evaluations.
    visits : Visits
        Where its feasible candidates lie.
    front : Front
        What it found, with its seed and settings.
    """

    kind: ClassVar[str] = "contest-run"
    version: ClassVar[int] = 1

    problem: str
    method: str
    budget: CountFromOne
    population: int | None
    scale: Scale
    marks: tuple[Mark, ...]
    visits: Visits
    front: Front

    @classmethod
    def of(
        cls, yardstick: Yardstick, method: str, budget: int, population: int | None, run: BudgetRun
    ) -> Self:
        """The run of a method on the problem of a yardstick."""
        return cls(
            yardstick.problem, method, budget, population, yardstick.scale, run.marks, run.visits,
            run.front,
        )  # fmt: skip

    @property
    def key(self) -> Key:
        """What it is kept under."""
        return Key(self.problem, self.method, self.front.seed or 0)


@dataclass(frozen=True)
class Folder:
    """Where a contest keeps its files.

    Parameters
    ----------
    path : Path
        The folder; made when something is written.
    """

    path: Path

    def save_run(self, run: Run) -> None:
        """Write a run, whole or not at all."""
        self._save(run, self._run_path(run.key))

    def save_yardstick(self, yardstick: Yardstick) -> None:
        """Write a yardstick, whole or not at all."""
        self._save(yardstick, self.path / _YARDSTICKS / f"{yardstick.problem}.json")

    def runs(self) -> dict[Key, Run]:
        """Every run in the folder.

        Returns
        -------
        dict of Key to Run
            In the order of their names.

        Raises
        ------
        FileFormatError
            When a file is no run, or not where its content says; with the remedy.
        """
        found = dict[Key, Run]()
        for path in sorted(self.path.glob(f"{_RUNS}/*/*/*.json")):
            run = _loaded(Run, path)
            if path != self._run_path(run.key):
                raise FileFormatError(
                    f"{path} holds the run of {run.method} on {run.problem} from seed "
                    f"{run.key.seed}; put it where that belongs, or remove it"
                )
            found[run.key] = run
        return dict(sorted(found.items()))

    def yardsticks(self) -> dict[str, Yardstick]:
        """Every yardstick in the folder, by its problem; errors as for `runs`."""
        paths = sorted(self.path.glob(f"{_YARDSTICKS}/*.json"))
        found = [_loaded(Yardstick, path) for path in paths]
        return {one.problem: one for one in found}

    def save_landscape(self, landscape: Landscape) -> None:
        """Write a landscape, whole or not at all."""
        self._save(landscape, self.path / _LANDSCAPES / f"{landscape.problem}.json")

    def landscapes(self) -> dict[str, Landscape]:
        """Every landscape in the folder, by its problem; errors as for `runs`."""
        paths = sorted(self.path.glob(f"{_LANDSCAPES}/*.json"))
        return {one.problem: one for one in (_loaded(Landscape, path) for path in paths)}

    def _run_path(self, key: Key) -> Path:
        return self.path / _RUNS / key.problem / key.method / f"seed{key.seed}.json"

    def _save(self, what: Saved, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        what.save(path)


def _loaded(kind: type[_Kind], path: Path) -> _Kind:
    try:
        return kind.load(path)
    except FileFormatError as error:
        raise FileFormatError(f"{error}; remove it to have it made again") from None


def check_alike(
    runs: Iterable[Run],
    yardsticks: Mapping[str, Yardstick],
    budget: int,
    population: int | None,
    folder: Path,
) -> None:
    """Refuse to add runs to those of a folder that cannot be compared with them.

    Parameters
    ----------
    runs : iterable of Run
        Those in the folder.
    yardsticks : mapping of str to Yardstick
        By problem.
    budget : int
        Evaluations that are asked for.
    population : int or None
        Individuals that are asked for.
    folder : Path
        What to call it in a message.

    Raises
    ------
    ValueError
        When a run has other evaluations, another population, or was measured against another
        exact front; in one line, with the remedy.
    """
    for run in runs:
        which = f"{run.method} on {run.problem} from seed {run.key.seed}"
        if run.budget != budget:
            raise ValueError(
                f"{folder} has runs of {run.budget} evaluations ({which}) and {budget} are asked "
                f"for; give --evaluations {run.budget}, or another --output"
            )
        if run.population != population:
            theirs = "the method's own" if run.population is None else run.population
            asked = "the method's own" if population is None else population
            raise ValueError(
                f"{folder} has a run whose population is {theirs} ({which}) and {asked} is asked "
                "for; give the same, or another --output"
            )
        if run.problem not in yardsticks:
            raise ValueError(
                f"{folder} has runs on {run.problem} without its exact front; put back "
                f"{folder / _YARDSTICKS / run.problem}.json, or give another --output"
            )
        if yardsticks[run.problem].scale != run.scale:
            raise ValueError(
                f"{folder} has a run that was measured against another exact front ({which}); "
                "remove the runs on this problem, or give another --output"
            )
