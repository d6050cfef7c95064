"""Where a contest keeps its files: exact fronts, runs, imported runs, local minima."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from quietarm.ocp import FileFormatError
from quietarm.ocp.base.files import check_inside
from quietarm.studies.contest.imported import Imported, Source
from quietarm.studies.contest.landscape import Landscape
from quietarm.studies.contest.names import folder_of
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.contest.runs import Key, Run

EXACT = "exact"
_RUNS, _IMPORTS, _LANDSCAPES = "runs", "imports", "landscape"
_Kind = TypeVar("_Kind", Run, Imported, Landscape, Yardstick)


@dataclass(frozen=True)
class Folder:
    """Where a contest keeps its files."""

    path: Path

    def save(self, what: Run | Imported | Landscape | Yardstick) -> None:
        """Write a file, whole or not at all; ValueError when it cannot be written."""
        path = self.place(what)
        path.parent.mkdir(parents=True, exist_ok=True)
        what.save(path)

    def runs(self) -> dict[Key, Run]:
        """Every run in the folder."""
        found = self._loaded(Run, f"{_RUNS}/*/*/*.json")
        return dict(sorted((run.key, run) for run in found))

    def imports(self) -> dict[Source, Imported]:
        """Every imported run in the folder; order and errors as for `runs`."""
        found = self._loaded(Imported, f"{_IMPORTS}/*/*/*.json")
        return dict(sorted((run.key, run) for run in found))

    def yardsticks(self) -> dict[str, Yardstick]:
        """Every yardstick in the folder, by its problem; errors as for `runs`."""
        found = self._loaded(Yardstick, f"{EXACT}/*.json")
        return {one.problem: one for one in found}

    def landscapes(self) -> dict[str, Landscape]:
        """Every landscape in the folder, by its problem; errors as for `runs`."""
        found = self._loaded(Landscape, f"{_LANDSCAPES}/*.json")
        return {one.problem: one for one in found}

    def place(self, what: Run | Imported | Landscape | Yardstick) -> Path:
        """Where it is kept."""
        if isinstance(what, Run):
            return self.place_of_run(what.key)
        if isinstance(what, Imported):
            parts = _IMPORTS, what.problem, folder_of(what.method), what.file
        else:
            parts = _LANDSCAPES if isinstance(what, Landscape) else EXACT, what.problem
        *folders, name = parts
        return self.path.joinpath(*folders, f"{name}.json")

    def place_of_run(self, key: Key) -> Path:
        """Where a run is kept, or will be."""
        method = folder_of(key.method)
        return self.path / _RUNS / key.problem / method / f"seed{key.seed}.json"

    def check_places(self, keys: Iterable[Key]) -> None:
        """Make sure that runs, and what goes with them, can be kept; ValueError says why not."""
        others = [self.path / name / "any" for name in (EXACT, _IMPORTS, _LANDSCAPES)]
        check_inside(self.path, [*others, *map(self.place_of_run, keys)])

    def _loaded(self, kind: type[_Kind], pattern: str) -> Iterable[_Kind]:
        for path in sorted(self.path.glob(pattern)):
            try:
                found = kind.load(path)
            except FileFormatError as error:
                raise FileFormatError(f"{error}; remove it to have it made again") from None
            if path != self.place(found):
                raise FileFormatError(
                    f"{path} holds {_words_of(found)}; put it where that belongs, or remove it"
                )
            yield found


def _words_of(what: Run | Imported | Landscape | Yardstick) -> str:
    if isinstance(what, Run):
        return f"the run of {what.words}"
    if isinstance(what, Imported):
        return what.words
    return f"what belongs to {what.problem}"


@dataclass
class Contents:
    """What the folder of a contest holds, read once and kept up to date."""

    folder: Folder
    runs: dict[Key, Run] = field(default_factory=dict)
    imports: dict[Source, Imported] = field(default_factory=dict)
    yardsticks: dict[str, Yardstick] = field(default_factory=dict)
    landscapes: dict[str, Landscape] = field(default_factory=dict)

    @classmethod
    def of(cls, path: Path) -> Contents:
        """What a folder holds; FileFormatError where a file in it is broken."""
        folder = Folder(path)
        return cls(
            folder, folder.runs(), folder.imports(), folder.yardsticks(), folder.landscapes()
        )

    def keep(self, what: Run | Imported | Landscape | Yardstick) -> None:
        """Write a file and know of it; ValueError when it cannot be written."""
        self.folder.save(what)
        if isinstance(what, Run):
            self.runs[what.key] = what
        elif isinstance(what, Imported):
            self.imports[what.key] = what
        elif isinstance(what, Landscape):
            self.landscapes[what.problem] = what
        else:
            self.yardsticks[what.problem] = what
