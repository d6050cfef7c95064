"""The dataset of a sweep: laid out first, then written region by region, as Zarr by xarray."""

from __future__ import annotations

import hashlib
import json
import os
import stat
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from quietarm.interrupts import note_interrupts
from quietarm.ocp import FileFormatError, QuietarmError
from quietarm.ocp.checks import cut, install, quoted
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.files import unwritable
from quietarm.ocp.json_text import refuse_repeated
from quietarm.ocp.limits import SWEEP
from quietarm.ocp.record import versions
from quietarm.ocp.saved import plain, typed
from quietarm.studies.sweep.cell_interpolation import find_jumps
from quietarm.studies.sweep.definition import (
    COEFFICIENTS,
    DIGEST,
    JUMP,
    SOLVED_BY,
    STATUS,
    Definition,
)

if TYPE_CHECKING:
    import pandas
    import xarray

_FORMAT = "quietarm-sweep"
_DIGESTED = "variables"
"""Attribute of the digests: the names of the variables that they are of."""


class Store:
    """The dataset of a sweep; FileFormatError where a folder is none."""

    def __init__(self, path: Path) -> None:
        # variables that begin so are of limited quantities, of which a dataset has those of its
        # time, as of what is newer than version 2.0.0
        prefix = "peak_"
        self.path = path
        with _undisturbed():
            self.dataset = _open(path)
        with _undisturbed(), _damage_told(path):
            self.definition = typed(self.note("sweep"), Definition)
            newer = {SOLVED_BY, *(figure.name for figure in self.definition.figures)}
            self._names = [
                name
                for name in self.definition.variables
                if name != JUMP
                and (name in self.dataset or not (name.startswith(prefix) or name in newer))
            ]
            self._digested = self._read_digested()
            self._check_layout()

    @classmethod
    def of(cls, path: Path, definition: Definition) -> Store:
        """The store of a sweep, made where there is none; FileFormatError if it is of another."""
        if not path.exists():
            with _refusal_told(path):
                _lay_out(path, definition)
        store = cls(path)
        differing = ", ".join(
            filter(None, [definition.difference(store.definition), *store._other_figures()])
        )
        if differing:
            raise FileFormatError(
                f"{path} is of another sweep: it differs in {differing}; give the line of that "
                "sweep, or another name"
            )
        return store

    def _read_digested(self) -> list[str]:
        """Return the names of the variables that have digests, in their order.

        A dataset states them, because it may hold figures that are not known here. One of before
        has digests of the variables that are known.
        """
        if not self._has_digests or _DIGESTED not in self.dataset[DIGEST].attrs:
            return self._names
        stated = self.dataset[DIGEST].attrs[_DIGESTED]
        variables = {str(name) for name in self.dataset.data_vars} - {JUMP, DIGEST}
        names = [*map(str, stated)] if isinstance(stated, list) else []
        if {*names} != variables or len(names) != len(variables):
            raise ValueError(f"its digests are of {quoted(stated)}")
        return names

    def _other_figures(self) -> list[str]:
        """Return names of figures that are known here or held there, and not both."""
        known = {figure.name for figure in self.definition.figures}
        return sorted((known - {*self._names}) | ({*self._digested} - {*self._names}))

    @property
    def figures(self) -> list[Figure]:
        """Figures of a user's own, and peaks that are shown, of which the dataset has values."""
        known = further_figures(SWEEP, self.definition.grid.task)
        return [figure for figure in known if figure.name in self._names]

    def _check_layout(self) -> None:
        """Hold axes and variables against what was asked; ValueError where they are others."""
        for axis in self.definition.grid.axes:
            if not np.array_equal(self.dataset[axis.name].to_numpy(), np.array(axis.values)):
                raise ValueError(f"axis {axis.name} has other values than were asked for")
        for name in [*self._names, JUMP]:
            _, beside, empty, _ = self.definition.variables[name]
            shape = (*self.definition.grid.shape, *beside.values())
            variable = self.dataset[name]
            if (variable.shape, variable.dtype) != (shape, np.asarray(empty).dtype):
                raise ValueError(f"variable {name} has another shape or type than was asked for")

    def read(self, name: str) -> NDArray[Any]:
        """All of a variable; FileFormatError where a file of it is broken, or was changed.

        The states are read first and the digests last, since others may write at the same time. A
        dataset of before has no digests, and nothing to hold its values against.
        """
        with _undisturbed(), _damage_told(self.path / name):
            status = self.dataset[STATUS].to_numpy()
            values = status if name == STATUS else self.dataset[name].to_numpy()
            if name == JUMP or not self._has_digests:
                return values
            digests = self.dataset[DIGEST].to_numpy()[:, self._digested.index(name)]
        for digest, chunk in zip(digests.tolist(), self.definition.chunks):
            if (status[chunk] != 0).any() and digest != self._digest_of(values[chunk]):
                raise FileFormatError(
                    f"{self.path}: {name} is not what was swept; remove the dataset and sweep it "
                    "again"
                )
        return values

    @property
    def _has_digests(self) -> bool:
        return DIGEST in self.dataset

    def _digest_of(self, values: NDArray[Any]) -> int:
        """Return the digest of a variable's computed part, as an answer to what was asked."""
        content = self.dataset.attrs["sweep"].encode() + np.ascontiguousarray(values).tobytes()
        return int.from_bytes(hashlib.sha256(content).digest()[:7], "little")

    def check(self) -> None:
        """Read all variables; FileFormatError where one was changed."""
        for name in self._names:
            self.read(name)

    def missing(self, part: tuple[int, int] = (1, 1)) -> list[int]:
        """The chunks of a part, i of n, that are not computed."""
        number, of = part
        status = self.read(STATUS)
        chunks = [*enumerate(self.definition.chunks)][number - 1 :: of]
        return [k for k, chunk in chunks if (status[chunk] == 0).any()]

    def write(self, number: int, cells: pandas.DataFrame) -> None:
        """Write a chunk; its status last, so that a killed run computes it again."""
        names = self.definition.grid.names
        region = dict(zip(names, self.definition.chunks[number]))
        part = self.dataset.drop_vars([*names, JUMP, DIGEST], errors="ignore").isel(region).load()
        for name, column in cells.items():
            if name not in self._names:  # of a quantity that is newer than the dataset
                continue
            places = part[name].to_numpy().reshape(len(cells), -1)
            for place, value in zip(places, column):
                place[: np.size(value)] = np.ravel(value)
        if self._has_digests:
            digests = [self._digest_of(part[name].to_numpy()) for name in self._digested]
            digest = self.dataset[[DIGEST]].isel(chunk=[number]).copy(data={DIGEST: [digests]})
            self._write(digest, {"chunk": slice(number, number + 1)})
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
        """Return the entries of an attribute; empty where there is none.

        FileFormatError if it holds no table.
        """
        with _damage_told(self.path):
            text = self.dataset.attrs.get(name, "{}")
            note = json.loads(text)
            refuse_repeated(text)
            if not isinstance(note, dict):
                raise ValueError(f"{name} is {quoted(note)}")
            return note

    def kept(self, name: str) -> dict[str, Any]:
        """Return what `keep` has kept; empty where that was changed since."""
        with suppress(FileFormatError):
            note = self.note(name)
            if note.pop(DIGEST, None) == self._digest_of_note(note):
                return note
        return {}

    def _digest_of_note(self, entries: Mapping[str, Any]) -> int:
        return self._digest_of(np.frombuffer(json.dumps(entries).encode(), np.uint8))

    def keep(self, name: str, entries: Mapping[str, Any]) -> None:
        """Keep a few numbers about the dataset as an attribute."""
        import zarr

        text = json.dumps({**entries, DIGEST: self._digest_of_note(entries)})
        with _refusal_told(self.path):
            zarr.open_group(self.path, mode="r+").attrs[name] = text
        self.dataset.attrs[name] = text


def _lay_out(path: Path, definition: Definition) -> None:
    """Make a dataset whole or not at all, also where two begin at once.

    By zarr, which writes what the arrays are: xarray visits every chunk of what is empty.
    """
    _xarray()
    import zarr

    texts = {"sweep": json.dumps(plain(definition)), "versions": json.dumps(versions())}
    with _undisturbed(), tempfile.TemporaryDirectory(dir=path.parent, prefix=".sweep-") as folder:
        place = Path(folder) / "store"
        group: Any = zarr.create_group(place, attributes={"format": _FORMAT, **texts})
        for name, array in _arrays(definition).items():
            group.create_array(name, **array)
        for axis in definition.grid.axes:
            group[axis.name][:] = np.array(axis.values)
        with suppress(OSError):  # another process was first
            os.rename(place, path)


def _arrays(definition: Definition) -> dict[str, dict[str, Any]]:
    """Return what zarr is told of the axes, the variables and the digests."""
    grid = definition.grid
    variables = definition.variables
    arrays: dict[str, dict[str, Any]] = {}
    for axis in grid.axes:
        arrays[axis.name] = {
            "shape": (len(axis.values),),
            "dtype": float,
            "dimension_names": [axis.name],
            "attributes": {"units": axis.unit},
        }
    for name, (unit, beside, empty, attributes) in variables.items():
        sizes = tuple(beside.values())
        arrays[name] = {
            "shape": (*grid.shape, *sizes),
            "chunks": (*definition.chunk, *sizes),
            "dtype": np.asarray(empty).dtype,
            "fill_value": empty,
            "dimension_names": [*grid.names, *beside],
            "attributes": {"units": unit, **attributes},
        }
    of_chunk = len(variables) - 1  # without the jumps, which follow from the others
    arrays[DIGEST] = {
        "shape": (len(definition.chunks), of_chunk),
        "chunks": (1, of_chunk),
        "dtype": np.int64,
        "fill_value": 0,
        "dimension_names": ["chunk", "variable"],
        "attributes": {_DIGESTED: [name for name in variables if name != JUMP]},
    }
    return arrays


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Let Ctrl-C wait for the end of the block: zarr's own thread would go on without this one."""
    with note_interrupts() as came:
        yield
    if came:
        raise came[0]


@contextmanager
def _refusal_told(path: Path) -> Iterator[None]:
    """Name the dataset where the system refuses to write it: a full disk says no name."""
    try:
        yield
    except OSError as error:
        raise unwritable(path, error) from error


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """Tell whatever zarr makes of a damaged dataset in a line."""
    try:
        yield
    except FileFormatError:  # told already
        raise
    except Exception as error:
        raise FileFormatError(
            f"{path} is damaged, changed or of another version ({type(error).__name__}: "
            f"{cut(str(error), 200)}); remove the dataset and sweep it again"
        ) from None


def _xarray() -> Any:
    reason = f"the dataset of a sweep needs xarray and zarr; {install('sweep')}"
    try:
        import_module("zarr")
        return import_module("xarray")
    except ImportError:
        raise ValueError(reason) from None


def _open(path: Path) -> xarray.Dataset:
    """The dataset, whose values are read when they are asked for; FileFormatError if it is none."""
    xr = _xarray()
    if not path.exists():
        raise FileFormatError(f"{path}: there is no such dataset; sweep it, or give another name")
    _check_files(path)
    if _stated_format(path) != _FORMAT:
        raise FileFormatError(f"{path} is no dataset of a sweep; give another name")
    _read_descriptions(path)
    with _damage_told(path), warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # of what was changed, which `Store` finds and tells in a line
        return xr.open_dataset(path, engine="zarr", consolidated=False, cache=False)


def _check_files(path: Path) -> None:
    """Refuse what zarr would read without an end: pipes, devices, and files of any size."""
    most_bytes = 10**9
    for folder, _, names in os.walk(path):
        for name in names:
            file = Path(folder, name)
            with suppress(OSError):  # gone again, or a link that leads nowhere: zarr tells it
                facts = file.stat()
                if not stat.S_ISREG(facts.st_mode):
                    raise FileFormatError(
                        f"{file} is no ordinary file; remove the dataset and sweep it again"
                    )
                if facts.st_size > most_bytes:
                    raise FileFormatError(
                        f"{file} has {facts.st_size / 1e6:.0f} MB; a file of a dataset has at most "
                        f"{most_bytes / 1e6:.0f} MB: remove it and sweep it again"
                    )


def _stated_format(path: Path) -> object:
    """The format that a folder states; None where it states none."""
    import zarr

    with suppress(Exception):  # whatever zarr makes of another file or folder
        return zarr.open_group(path, mode="r").attrs.get("format")
    return None


def _read_descriptions(path: Path) -> None:
    """Read what each array says of itself, one after another; FileFormatError where one is changed.

    xarray has zarr read all of them at once: where one fails, the rest is dropped unfinished, and
    says so in many lines when the process ends.
    """
    import zarr

    for description in sorted(path.glob("*/zarr.json")):
        with _damage_told(description):
            zarr.open_array(description.parent, mode="r")
