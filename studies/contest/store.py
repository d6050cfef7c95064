"""The folder of a contest: its exact fronts, runs, imported runs and local minima, a file each."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Any, Protocol, Self

from quietarm.ocp import FileFormatError
from quietarm.ocp.base.files import check_inside
from quietarm.studies.contest.imported import Imported, Source
from quietarm.studies.contest.landscape import Landscape
from quietarm.studies.contest.names import folder_of
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.contest.runs import Key, Run


class _Kept(Protocol):
    """What a store keeps: under a key, in a file of its own."""

    @property
    def key(self) -> Hashable: ...

    @classmethod
    def load(cls, path: str | Path) -> Self: ...

    def save(self, path: str | Path) -> None: ...


_FOLDERS: dict[type[_Kept], str] = {
    Yardstick: "exact", Run: "runs", Imported: "imports", Landscape: "landscape",
}  # fmt: skip


class Store:
    """What the folder of a contest holds, read once and kept up to date.

    FileFormatError where a file in it is broken, or in the place of another.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._kept = {kind: self._read(kind) for kind in _FOLDERS}

    @property
    def runs(self) -> dict[Key, Run]:
        """Every run."""
        return self._of(Run)

    @property
    def imports(self) -> dict[Source, Imported]:
        """Every imported run."""
        return self._of(Imported)

    @property
    def yardsticks(self) -> dict[str, Yardstick]:
        """Every yardstick by its problem."""
        return self._of(Yardstick)

    @property
    def landscapes(self) -> dict[str, Landscape]:
        """Every landscape by its problem."""
        return self._of(Landscape)

    def keep(self, what: _Kept) -> None:
        """Write a file, whole or not at all, and know of it; ValueError when it cannot be."""
        path = self.place(type(what), what.key)
        path.parent.mkdir(parents=True, exist_ok=True)
        what.save(path)
        self._of(type(what))[what.key] = what

    def place(self, kind: type[_Kept], key: Any) -> Path:
        """Where something of a kind is kept under its key."""
        if isinstance(key, str):
            parts = (key,)
        else:
            problem, method, last = key
            parts = problem, folder_of(method), f"seed{last}" if kind is Run else last
        *folders, name = parts
        return self.path.joinpath(_FOLDERS[kind], *folders, f"{name}.json")

    def _of(self, kind: type[_Kept]) -> dict[Any, Any]:
        return self._kept[kind]

    def _read(self, kind: type[_Kept]) -> dict[Hashable, _Kept]:
        found = dict[Any, _Kept]()
        for path in sorted(self.path.glob(f"{_FOLDERS[kind]}/**/*.json")):
            try:
                one = kind.load(path)
            except FileFormatError as error:
                raise FileFormatError(f"{error}; remove it to have it made again") from None
            if path != self.place(kind, one.key):
                raise FileFormatError(
                    f"{path} holds what belongs to {self.place(kind, one.key)}; put it there, or "
                    "remove it"
                )
            found[one.key] = one
        return dict(sorted(found.items()))


def check_places(path: Path, keys: Iterable[Key]) -> None:
    """Make sure that runs, and what goes with them, can be kept; ValueError says why not."""
    folders = [path / name / "any" for name in _FOLDERS.values()]
    runs = [path / "runs" / key.problem / folder_of(key.method) / "any" for key in keys]
    check_inside(path, [*folders, *runs])
