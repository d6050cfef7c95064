"""The dataset of a sweep: laid out first, then written region by region, as Zarr by xarray."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError, QuietarmError
from quietarm.ocp.checks import install
from quietarm.ocp.record import versions
from quietarm.ocp.saved import plain, typed
from quietarm.studies.sweep.definition import COEFFICIENTS, JUMP, STATUS, Definition
from quietarm.studies.sweep.interpolation import find_jumps

if TYPE_CHECKING:
    import pandas
    import xarray

NEEDS = f"the dataset of a sweep needs xarray and zarr; {install('sweep')}"
_FORMAT = "quietarm-sweep"


class Store:
    """The dataset of a sweep; FileFormatError where a folder is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.dataset = _open(path)
        with _damage_told(path):
            self.definition = typed(self.note("sweep"), Definition)

    @classmethod
    def of(cls, path: Path, definition: Definition) -> Store:
        """The store of a sweep, made where there is none; FileFormatError if it is of another."""
        if not path.exists():
            _lay_out(path, definition)
        store = cls(path)
        if differing := definition.difference(store.definition):
            raise FileFormatError(
                f"{path} is of another sweep: it differs in {differing}; give the line of that "
                "sweep, or another name"
            )
        return store

    def read(self, name: str) -> NDArray[Any]:
        """All of a variable; FileFormatError where a file of it is broken."""
        with _damage_told(self.path / name):
            return self.dataset[name].to_numpy()

    def missing(self, part: tuple[int, int] = (1, 1)) -> list[int]:
        """The chunks of a part, i of n, that are not computed."""
        (number, of), status = part, self.read(STATUS)
        chunks = [*enumerate(self.definition.chunks)][number - 1 :: of]
        return [k for k, chunk in chunks if (status[chunk] == 0).any()]

    def write(self, number: int, cells: pandas.DataFrame) -> None:
        """Write a chunk; its status last, so that a killed run computes it again."""
        names = self.definition.grid.names
        region = dict(zip(names, self.definition.chunks[number]))
        part = self.dataset.drop_vars([*names, JUMP]).isel(region).load()
        for name, column in cells.items():
            places = part[name].to_numpy().reshape(len(cells), -1)
            for place, value in zip(places, column):
                place[: np.size(value)] = np.ravel(value)
        for some in (part.drop_vars(STATUS), part[[STATUS]]):
            self._write(some, region)

    def mark_jumps(self) -> None:
        """Mark where the least energy jumps from one motion to another, once all is computed."""
        axes = [np.array(axis.values) for axis in self.definition.grid.axes]
        marks = self.dataset[[JUMP]].copy(data={JUMP: find_jumps(axes, self.read(COEFFICIENTS))})
        self._write(marks.drop_vars(self.definition.grid.names), None)

    def _write(self, some: xarray.Dataset, region: Any) -> None:
        try:
            some.to_zarr(self.path, mode="r+", consolidated=False, region=region)
        except OSError as error:  # nothing is damaged: the chunk counts as not computed
            raise QuietarmError(
                f"{self.path}: {error.strerror or error}; make room, and give the same line again"
            ) from None

    def note(self, name: str) -> Any:
        """What an attribute holds; empty where there is none."""
        return json.loads(self.dataset.attrs.get(name, "{}"))

    def keep(self, name: str, entries: Mapping[str, Any]) -> None:
        """Keep a few numbers about the dataset as an attribute."""
        import zarr

        text = json.dumps(entries)
        zarr.open_group(self.path, mode="r+").attrs[name] = text
        self.dataset.attrs[name] = text


def _lay_out(path: Path, definition: Definition) -> None:
    """Make a dataset whole or not at all, also where two begin at once."""
    xr, grid = _xarray(), definition.grid
    variables: dict[str, Any] = {
        axis.name: (axis.name, np.array(axis.values), {"units": axis.unit}) for axis in grid.axes
    }
    for name, (unit, beside, empty, attributes) in definition.variables.items():
        sizes = beside.values()
        nothing = np.broadcast_to(empty, [*grid.shape, *sizes])  # takes no memory
        how = {"chunks": (*definition.chunk, *sizes), "_FillValue": None, "fill_value": empty}
        variables[name] = [*grid.names, *beside], nothing, {"units": unit, **attributes}, how
    texts = {"sweep": json.dumps(plain(definition)), "versions": json.dumps(versions())}
    dataset = xr.Dataset(variables, attrs={"format": _FORMAT, **texts})
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".sweep-") as folder:
        place = Path(folder) / "store"
        dataset.to_zarr(place, consolidated=False, zarr_format=3)
        with suppress(OSError):  # another process was first
            os.rename(place, path)


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """Tell whatever zarr makes of a damaged dataset in a line."""
    try:
        yield
    except Exception as error:
        raise FileFormatError(
            f"{path} is damaged or of another version ({type(error).__name__}); remove the dataset "
            "and sweep it again"
        ) from None


def _xarray() -> Any:
    try:
        import_module("zarr")
        return import_module("xarray")
    except ImportError:
        raise ValueError(NEEDS) from None


def _open(path: Path) -> xarray.Dataset:
    """The dataset, whose values are read when they are asked for; FileFormatError if it is none."""
    xr = _xarray()
    if not path.exists():
        raise FileFormatError(f"{path}: there is no such dataset; sweep it, or give another name")
    with suppress(Exception):  # whatever zarr makes of another file or folder
        dataset = xr.open_dataset(path, engine="zarr", consolidated=False, cache=False)
        if dataset.attrs.get("format") == _FORMAT:
            return dataset
    raise FileFormatError(f"{path} is no dataset of a sweep; give another name")
