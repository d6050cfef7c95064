"""Tables of numbers from files of other programs: text, NumPy's arrays and MATLAB's files."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.tables.column_units import KINDS, UNITS, kind_of, normal, split_name
from quietarm.machine.tables.matlab import read_matlab
from quietarm.machine.tables.text import read_columns
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import cut, listed, nearest, quoted
from quietarm.ocp.files import MOST_BYTES, read_bytes

Array = NDArray[np.float64]
ARRAYS = (".npy", ".npz", ".mat")
"""Endings of files of arrays; any other is a text."""
TABLES = (".csv", ".txt", ".dat", *ARRAYS)
"""Endings by which a table is told from numbers."""
_LABELS = ("label", "name", "signalname")
_SAMPLES = ("values", "data")
"""Fields of a structure that is one signal, as Simulink and recorders write it."""
_MOST_ROWS = 2_000_000
_MOST_COLUMNS = 1000
_MOST_OF_ARRAY = 10_000
"""Rows and columns of a text, and columns of an array, which may be a long row."""
_CALLED = {
    "time": {"time", "t", "x_value", "x value", "timestamp", "zeit", "sec", "seconds", "ms", "us",
             "ns", "millis", "micros", "nanos", "milliseconds", "microseconds", "nanoseconds"},
    "angle": {"angle", "theta", "position", "q"},
    "position": {"position", "x", "s", "q"},
}  # fmt: skip


@dataclass(frozen=True)
class Column:
    """A column of a file: its heading, its unit where it stands elsewhere, its numbers."""

    name: str
    unit: str
    values: Array

    @property
    def written(self) -> str:
        """Unit of the column, wherever it is written; empty where it is nowhere.

        Of a time a heading may be nothing else, as ``micros`` of the sketches of small boards.
        """
        alone = self.name.strip().removesuffix("()")
        is_time = _plain(alone) in _CALLED["time"] and normal(alone) in UNITS["time"]
        return self.unit or split_name(self.name)[1] or (alone if is_time else "")


@dataclass(frozen=True)
class Table:
    """The columns of a file, in its order; and names of those that hold words."""

    path: Path
    columns: tuple[Column, ...]
    words: tuple[str, ...] = ()

    def find(self, name: str) -> Column:
        """A column by its heading, or by its number from 0; FileFormatError where there is none.

        Of a structure the last field serves, where no other column ends in it.
        """
        for of_column, of_name in (
            (str, str), (_plain, _plain), (_without_unit, _plain), (_without_unit, _without_unit),
            (_last_field, _last_field),
        ):  # fmt: skip
            places = [
                k
                for k, column in enumerate(self.columns)
                if of_column(column.name) == of_name(name)
            ]
            if len(places) > 1:
                raise FileFormatError(
                    f"{self.path}: {len(places)} columns are called {quoted(name)}; give one's "
                    f"number, {' or '.join(map(str, places))}"
                )
            if places:
                return self.columns[places[0]]
        if name.isdecimal() and int(name) < len(self.columns):
            return self.columns[int(name)]
        names = [column.name for column in self.columns]
        near = nearest(name, names) if names else ""
        raise FileFormatError(f"{self.path} has no column {quoted(name)}{near}; {self.listed()}")

    def first(self, quantity: str, remedy: str) -> str:
        """The first column that is called as a time, an angle or a position is.

        FileFormatError with the remedy where none is.
        """
        for column in self.columns:
            names = {_plain(column.name), _without_unit(column.name), _last_field(column.name)}
            if names & _CALLED[quantity]:
                return column.name
        if quantity == "time" and self.columns and self._first_is_time():
            return self.columns[0].name
        raise FileFormatError(
            f"{self.path} has no column called {quantity}; {remedy}; {self.listed()}"
        )

    def listed(self) -> str:
        """Return the columns by name, in words; a number serves as well."""
        most = 12
        names = [column.name for column in self.columns[:most]]
        more = ", ..." if len(self.columns) > most else ""
        return f"its columns, by name or by number from 0, are {listed(names)}{more}"

    def _first_is_time(self) -> bool:
        """Return whether the first column rises evenly, and does not only count the rows.

        A counter that wraps rises as well.
        """
        first = self.columns[0]
        if len(self.columns) < 2 or not _rises(first.values):
            return False
        counts = (np.diff(first.values[np.isfinite(first.values)]) == 1).all()
        return not counts or normal(first.written) in UNITS["time"]

    def in_si(self, name: str, quantity: str, unit: str = "", scale: float | None = None) -> Array:
        """A column in SI units: by a scale, a unit, that of its name, or as it is."""
        return self.find(name).values * self.factor(name, quantity, unit, scale)

    def factor(
        self,
        name: str,
        quantity: str,
        unit: str = "",
        scale: float | None = None,
        option: str = "",
    ) -> float:
        """Return a column's factor to SI units: by a scale, a unit, that of its name, or 1.

        A unit that is given holds whatever the name says. FileFormatError where its name ends in
        what may be a unit or not, or is one of something else; it names the options of a command
        that has some, which call the quantity by `option`.
        """
        column = self.find(name)
        known = UNITS[quantity]
        if scale is not None:
            return scale
        written = unit or column.written
        if normal(written) in known or not written:
            return known.get(normal(written), 1.0)
        usual = next(iter(known))
        how = f"name the column {quantity}_{usual}"
        if option:
            how = f"give the {quantity}'s by --units {option}:{usual}, or by --scale {option}=..."
        kind = kind_of(written)
        if kind:
            raise FileFormatError(
                f"{self.path}: {quoted(written)} of column {column.name} is a unit of {kind}, and "
                f"not of {KINDS.get(quantity, quantity)}; {how}"
            )
        raise FileFormatError(
            f"{self.path}: is {quoted(written)} of column {column.name} a unit? {how}"
        )

    def unused(self, names: Collection[str]) -> tuple[str, ...]:
        """Columns that are none of these, by their names in words."""
        used = [self.find(name) for name in names]
        left = [column.name for column in self.columns if not any(column is one for one in used)]
        return (*left, *self.words)


def unused_in_words(unused: Sequence[str]) -> str:
    """Say that columns are not used; empty where all are."""
    most = 8
    if not unused:
        return ""
    names = ", ".join(unused[:most])
    more = f" and {len(unused) - most} more" if len(unused) > most else ""
    columns = "column" if len(unused) == 1 else "columns"
    return f"not used: {columns} {names}{more}"


def _rises(values: Array) -> bool:
    """Return whether numbers rise evenly, but where a counter wraps or a recording begins anew."""
    few = 0.01  # share of the steps that go back
    finite = values[np.isfinite(values)]
    back = np.diff(finite) < 0
    if not back.any() or np.count_nonzero(back) > max(1.0, few * len(back)):
        return rises_evenly(values)
    runs = np.split(finite, np.flatnonzero(back) + 1)
    return rises_evenly(max(runs, key=len))


def rises_evenly(values: Array) -> bool:
    """Return whether numbers rise as the times of samples do: by the usual step.

    Some steps may be longer, where samples lack. Stamps may be rounded: to so much that several are
    the same.
    """
    least_steps = 8
    # share of the steps that are the usual one where a column rises evenly
    even = 0.95
    steps = np.diff(values[np.isfinite(values)])
    rising = steps[steps > 0]
    if len(steps) < least_steps or (steps < 0).any() or len(rising) < len(steps) / 20:
        return False
    usual = max(float(np.median(steps)), float(np.ptp(values)) / len(steps))
    near = np.abs(steps - usual) <= max(0.25 * usual, 1.01 * float(rising.min()))
    return bool(near.mean() >= even)


def _plain(name: str) -> str:
    return name.strip().lower()


def _without_unit(name: str) -> str:
    return _plain(split_name(name)[0])


def _last_field(name: str) -> str:
    """Return the name of the field of a structure's column, without its unit."""
    return _without_unit(name.rpartition(".")[2])


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Say of which file an error is, whatever a parser makes of a damaged one."""
    try:
        yield
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except Exception as error:
        raise FileFormatError(
            f"{path}: it is no whole {path.suffix} file of numbers ({error}); save it again"
        ) from None


def read_table(path: Path, *, strict: bool = False) -> Table:
    """Read a file by its ending: .npy, .npz, .mat (up to version 7), and text for any other.

    In text the last row with as many cells before the first row of numbers names the columns; a row
    of units may stand between. A `strict` table has its rows as they are, be it one row or column,
    and in a text nothing but a heading above them. Nothing in a file is run.
    """
    # letters of a column's heading: more are no name, and would fill every message
    longest_name = 80
    content = read_bytes(path)
    words = list[str]()
    with reading(path):
        if path.suffix.lower() in ARRAYS:
            columns = _of_variables(_arrays(path.suffix.lower(), content, strict), strict)
        else:
            _refuse_huge(content)
            text = read_columns(content, strict)
            columns = [Column(*entry) for entry in text.numbers]
            words = text.words
    columns = [replace(column, name=cut(column.name, longest_name)) for column in columns]
    if not columns and not strict:
        raise FileFormatError(f"{path}: it has no vectors of numbers; save the time and what rings")
    return Table(path, tuple(columns), tuple(cut(name, longest_name) for name in words))


def _arrays(kind: str, content: bytes, strict: bool) -> dict[str, Any]:
    """Named arrays of a file of this ending, "" of one alone."""
    file = io.BytesIO(content)
    if kind == ".npy":
        return {"": np.load(file, allow_pickle=False)}
    if kind == ".npz":
        with zipfile.ZipFile(file) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > MOST_BYTES:  # compressed it may be a thousandth of that
            raise FileFormatError(
                f"its arrays take {size / 1e6:.0f} MB; give at most {MOST_BYTES / 1e6:.0f} MB, "
                "what is needed alone"
            )
        with np.load(file, allow_pickle=False) as arrays:
            return dict(arrays)
    values = read_matlab(content, simple=not strict)
    return {name: value for name, value in values.items() if not name.startswith("__")}


def _refuse_huge(content: bytes) -> None:
    """Refuse a text of more rows or columns than any recording has."""
    # bytes of a text's line: two hundred for each of the most columns. What no column can be is
    # not looked at letter by letter
    longest_line = 200_000
    rows = max(content.count(b"\n"), content.count(b"\r"))
    if rows > _MOST_ROWS:
        raise FileFormatError(f"it has {rows} rows; give at most {_MOST_ROWS}")
    for number, line in enumerate(content.splitlines(), start=1):
        if len(line) < 2 * _MOST_COLUMNS:
            continue
        columns = 1 + max(line.count(b","), line.count(b";"), line.count(b"\t"), line.count(b"|"))
        _refuse_wide(max(columns, len(line.split())), _MOST_COLUMNS)
        if len(line) > longest_line:
            raise FileFormatError(
                f"line {number} has {len(line)} letters; give at most {longest_line} in a line"
            )


def _refuse_wide(columns: int, most: int) -> None:
    if columns > most:
        raise FileFormatError(f"it has {columns} columns; give at most {most}")


def _of_variables(values: Mapping[str, Any], strict: bool, front: str = "") -> list[Column]:
    """Vectors by name, a matrix by name and column (``X:2``), a structure by field (``a.b``).

    Of several structures with a number, a signal by its label.
    """
    columns: list[Column] = []
    for name, value in values.items():
        array = np.asarray(value)
        if isinstance(value, Mapping):
            columns += _of_structure(value, strict, front, name)
        elif array.dtype == object and all(isinstance(element, Mapping) for element in array.flat):
            for k, element in enumerate(array.flat, 1):
                columns += _of_structure(element, strict, front, f"{name}:{k}")
        elif array.dtype.names:
            fields = {field: np.ravel(array[field]) for field in array.dtype.names}
            columns += _of_variables(fields, strict, front)
        else:
            columns += _of_array(front + name, array if strict else np.squeeze(array), strict)
    return columns


def _of_structure(fields: Mapping[str, Any], strict: bool, front: str, name: str) -> list[Column]:
    """A signal's samples by its label, or all fields of any other structure."""
    by_name = {field.lower(): value for field, value in fields.items()}
    labels = [by_name[field] for field in _LABELS if isinstance(by_name.get(field), str)]
    samples = next((by_name[field] for field in _SAMPLES if field in by_name), None)
    if samples is None or not any(field in by_name for field in _LABELS):
        return _of_variables(fields, strict, f"{front}{name}.")
    label = next(filter(None, (label.strip("<> ") for label in labels)), name)
    return _of_array(f"{front}{label}", np.squeeze(np.asarray(samples)), strict)


def _of_array(name: str, values: NDArray[Any], strict: bool) -> list[Column]:
    if values.dtype.kind not in "fiu" or values.ndim not in (1, 2):
        return []
    if values.size < 2 and not strict:
        return []
    if values.ndim == 1:
        return [Column(name or "0", "", values.astype(float))]
    rows = values.T if values.shape[0] < values.shape[1] and not strict else values
    _refuse_wide(rows.shape[1], _MOST_OF_ARRAY)
    first = 0 if not name else 1  # MATLAB counts from 1
    return [
        Column(f"{name}:{k}" if name else str(k), "", column.astype(float))
        for k, column in enumerate(rows.T, first)
    ]
