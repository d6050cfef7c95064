"""The dataset of a sweep, laid out first and then written chunk by chunk, as Zarr for xarray."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError, QuietarmError
from quietarm.ocp.checks import install
from quietarm.ocp.record import versions
from quietarm.studies.sweep.asked import COEFFICIENTS, JUMP, STATES, STATUS, Sweep
from quietarm.studies.sweep.branches import jumps

if TYPE_CHECKING:
    import zarr

Array = NDArray[np.float64]
NEEDS = f"the dataset of a sweep needs xarray and zarr; {install('sweep')}"


class Store:
    """The Zarr store of a sweep; FileFormatError where a folder is none."""

    def __init__(self, path: Path) -> None:
        self.path, self._group = path, _opened(path)
        with _told(path):
            self.sweep = Sweep.from_json(self._read("sweep"))
            names = (*self.sweep.variables, STATUS, JUMP)
            self._arrays: dict[str, Any] = {name: self._group[name] for name in names}

    @classmethod
    def of(cls, path: Path, sweep: Sweep) -> Store:
        """The store of a sweep, made where there is none; FileFormatError if it is of another."""
        if not path.exists():
            lay_out(path, sweep, sweep)
        store = cls(path)
        _check_same(path, store._read("asked"), _as_json(sweep))
        return store

    def _read(self, name: str) -> Any:
        return json.loads(str(self._group.attrs.get(name, "null")))

    @property
    def status(self) -> NDArray[np.int8]:
        """The numbers of `STATES` of all cells."""
        with _told(self.path / STATUS):
            return np.asarray(self._arrays[STATUS][...])

    def missing(self, part: tuple[int, int] = (1, 1)) -> list[int]:
        """The chunks of a part, i of n, that are not computed."""
        (number, of), status = part, self.status
        return [
            k for k, chunk in enumerate(self.sweep.grid.chunks)
            if k % of == number - 1 and (status[chunk] == 0).any()
        ]  # fmt: skip

    def keep(self, number: int, found: Mapping[str, Array]) -> None:
        """Write a chunk; its status last, so that a killed run computes it again."""
        chunk = self.sweep.grid.chunks[number]
        shape = tuple(cut.stop - cut.start for cut in chunk)
        try:
            for name in (*self.sweep.variables, STATUS):
                values = found[name]
                self._arrays[name][chunk] = values.reshape(*shape, *values.shape[1:])
        except OSError as error:  # nothing is damaged: the chunk counts as not computed
            raise QuietarmError(
                f"{self.path}: {error.strerror or error}; make room, and give the same line again"
            ) from None

    def mark_jumps(self) -> None:
        """Mark where the least energy jumps from one motion to another, once all is computed."""
        self._arrays[JUMP][...] = jumps(self.read(COEFFICIENTS))

    def read(self, name: str) -> Array:
        """All of a variable; FileFormatError where a file of it is broken."""
        with _told(self.path / name):
            return np.asarray(self._arrays[name][...])

    @property
    def versions(self) -> dict[str, str]:
        """Of what laid the dataset out."""
        return self._read("versions")

    def note(self, name: str, entries: Mapping[str, Any]) -> None:
        """Keep a few numbers about the dataset as an attribute."""
        self._group.attrs[name] = json.dumps(entries)

    def noted(self, name: str) -> dict[str, Any]:
        """What `note` kept; empty where it kept nothing."""
        return self._read(name) or {}


def lay_out(path: Path, asked: Sweep, sweep: Sweep) -> None:
    """Make a store whole or not at all, also where two begin at once.

    Its grid is that of `sweep`; what is asked may have a coarser one, to be refined.
    """
    zarr = _zarr()
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".sweep-") as folder:
        place = Path(folder) / "store"
        texts = {"asked": asked.to_json(), "sweep": sweep.to_json(), "versions": versions()}
        attributes = {name: json.dumps(one) for name, one in texts.items()}
        group = zarr.create_group(place, attributes={"format": "quietarm-sweep", **attributes})
        grid = sweep.grid
        dims = [axis.name for axis in grid.axes]

        def make(name: str, beside: Any, kind: str, empty: float, **own: Any) -> None:
            names, sizes = [name for name, _ in beside], [size for _, size in beside]
            group.create_array(
                name, shape=(*grid.shape, *sizes), chunks=(*grid.chunk, *sizes), dtype=kind,
                fill_value=empty, attributes=own, dimension_names=[*dims, *names],
            )  # fmt: skip

        for axis in grid.axes:
            group.create_array(
                axis.name, data=np.array(axis.values), dimension_names=[axis.name],
                attributes={"units": axis.unit},
            )  # fmt: skip
        for name, one in sweep.variables.items():
            make(name, one.beside, "float64", np.nan, units=one.unit)
        words = " ".join(state.replace(" ", "_") for state in STATES)
        make(STATUS, (), "int8", 0, units="1", flag_values=[*range(len(STATES))],
             flag_meanings=words)  # fmt: skip
        make(JUMP, (), "int32", 0, units="1", flag_masks=[1 << k for k in range(len(dims))],
             flag_meanings=" ".join(f"to_the_next_{name}" for name in dims))  # fmt: skip
        with suppress(OSError):  # another process was first
            os.rename(place, path)


def _as_json(sweep: Sweep) -> dict[str, Any]:
    return json.loads(json.dumps(sweep.to_json()))


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Tell whatever zarr makes of a damaged dataset in a line."""
    try:
        yield
    except Exception as error:
        raise FileFormatError(
            f"{path} is damaged ({type(error).__name__}); remove the dataset and sweep it again"
        ) from None


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise ValueError(NEEDS) from None
    return zarr


def _opened(path: Path) -> zarr.Group:
    """The Zarr group of a sweep; FileFormatError where it is none."""
    zarr = _zarr()
    if not path.exists():
        raise FileFormatError(f"{path}: there is no such dataset; sweep it, or give another name")
    with suppress(Exception):  # whatever zarr makes of another file or folder
        group = zarr.open_group(path, mode="r+")
        if group.attrs.get("format") == "quietarm-sweep":
            return group
    raise FileFormatError(f"{path} is no dataset of a sweep; give another name")


def _check_same(path: Path, there: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    for entry, mine in wanted.items():
        its = there.get(entry) or {}
        names = [name for name in {**mine, **its} if mine.get(name) != its.get(name)]
        if names:
            raise FileFormatError(
                f"{path} is of another sweep: {entry} differ in {', '.join(names)}; give the line "
                "of that sweep, or another name"
            )
