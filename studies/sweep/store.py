"""The dataset of a sweep: laid out first, then written region by region, as Zarr by xarray."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError, QuietarmError
from quietarm.ocp.checks import install
from quietarm.ocp.record import versions
from quietarm.studies.sweep.definition import COEFFICIENTS, JUMP, STATES, STATUS, Definition
from quietarm.studies.sweep.interpolation import find_jumps

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]
NEEDS = f"the dataset of a sweep needs xarray and zarr; {install('sweep')}"
_FORMAT = "quietarm-sweep"


class Store:
    """The dataset of a sweep; FileFormatError where a folder is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.dataset = _open(path)
        with damage_told(path):
            self.definition = Definition.from_json(self.note("sweep"))
            self._dims = [axis.name for axis in self.definition.grid.axes]

    @classmethod
    def of(cls, path: Path, definition: Definition) -> Store:
        """The store of a sweep, made where there is none; FileFormatError if it is of another."""
        if not path.exists():
            _lay_out(path, definition)
        store = cls(path)
        _check_same(path, store.note("sweep"), json.loads(json.dumps(definition.to_json())))
        return store

    def read(self, name: str) -> NDArray[Any]:
        """All of a variable; FileFormatError where a file of it is broken."""
        with damage_told(self.path / name):
            return self.dataset[name].to_numpy()

    def missing(self, part: tuple[int, int] = (1, 1)) -> list[int]:
        """The chunks of a part, i of n, that are not computed."""
        (number, of), status = part, self.read(STATUS)
        return [
            k for k, chunk in enumerate(self.definition.grid.chunks)
            if k % of == number - 1 and (status[chunk] == 0).any()
        ]  # fmt: skip

    def write(self, number: int, columns: Mapping[str, Array]) -> None:
        """Write a chunk; its status last, so that a killed run computes it again."""
        chunk = self.definition.grid.chunks[number]
        shape = [cut.stop - cut.start for cut in chunk]
        beside = {name: one.beside for name, one in self.definition.variables.items()}
        region = {
            name: ([*self._dims, *dict(beside.get(name, ()))],
                   values.reshape(*shape, *values.shape[1:]))
            for name, values in columns.items()
        }  # fmt: skip
        status = {STATUS: region.pop(STATUS)}
        for variables in (region, status):
            self._write(variables, region=dict(zip(self._dims, chunk, strict=True)))

    def mark_jumps(self) -> None:
        """Mark where the least energy jumps from one motion to another, once all is computed."""
        axes = [np.array(axis.values) for axis in self.definition.grid.axes]
        self._write({JUMP: (self._dims, find_jumps(axes, self.read(COEFFICIENTS)))})

    def _write(self, variables: Mapping[str, Any], **place: Any) -> None:
        try:
            _xarray().Dataset(variables).to_zarr(self.path, mode="r+", consolidated=False, **place)
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
    xr = _xarray()
    grid = definition.grid
    variables, encoding = dict[str, Any](), dict[str, Any]()

    def add(name: str, beside: Any, empty: Any, **attributes: Any) -> None:
        names, sizes = dict(beside), [size for _, size in beside]
        values = np.broadcast_to(empty, [*grid.shape, *sizes])  # takes no memory
        variables[name] = [axis.name for axis in grid.axes] + [*names], values, attributes
        encoding[name] = {"chunks": (*grid.chunk, *sizes), "_FillValue": None, "fill_value": empty}

    for name, one in definition.variables.items():
        add(name, one.beside, np.float64("nan"), units=one.unit)
    words = " ".join(state.replace(" ", "_") for state in STATES)
    add(STATUS, (), np.int8(0), units="1", flag_values=[*range(len(STATES))], flag_meanings=words)
    edges = " ".join(f"to_the_next_{axis.name}" for axis in grid.axes)
    masks = [1 << k for k in range(len(grid.axes))]
    add(JUMP, (), np.int32(0), units="1", flag_masks=masks, flag_meanings=edges)
    axes = {axis.name: (axis.name, np.array(axis.values), {"units": axis.unit})
            for axis in grid.axes}  # fmt: skip
    texts = {"sweep": definition.to_json(), "versions": versions()}
    attributes = {"format": _FORMAT, **{name: json.dumps(one) for name, one in texts.items()}}
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".sweep-") as folder:
        place = Path(folder) / "store"
        empty = xr.Dataset(variables, axes, attributes)
        empty.to_zarr(place, encoding=encoding, consolidated=False, zarr_format=3)
        with suppress(OSError):  # another process was first
            os.rename(place, path)


@contextmanager
def damage_told(path: Path) -> Iterator[None]:
    """Tell whatever zarr makes of a damaged dataset in a line."""
    try:
        yield
    except Exception as error:
        raise FileFormatError(
            f"{path} is damaged ({type(error).__name__}); remove the dataset and sweep it again"
        ) from None


def _xarray() -> Any:
    if find_spec("xarray") is None or find_spec("zarr") is None:
        raise ValueError(NEEDS)
    return import_module("xarray")


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


def _check_same(path: Path, there: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    for entry, mine in wanted.items():
        its = there.get(entry) or {}
        names = [name for name in {**mine, **its} if mine.get(name) != its.get(name)]
        if names:
            raise FileFormatError(
                f"{path} is of another sweep: {entry} differ in {', '.join(names)}; give the line "
                "of that sweep, or another name"
            )
