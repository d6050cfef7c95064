"""Headings and cells of a table of waypoints: joints by name, with units or without."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from quietarm.models.units import UNITS, is_number, parse_quantity

_IN_BRACKETS = re.compile(r"(.+?)\s*[\[(]\s*([^\[\]()]+?)\s*[\])]")
_BEHIND = re.compile(r"(.+)_([A-Za-zµ°]+)")
_AS_EXPORTED = ("angle", "position")
"""What a table of `export` calls the positions of joints that turn, and of those that slide."""
_PER_UNIT = {
    unit: per_unit
    for si_unit in ("rad", "m")
    for unit, per_unit in UNITS[si_unit][1].items()
}  # fmt: skip


@dataclass(frozen=True)
class Headings:
    """Columns of a table: the joint and the unit of each.

    Attributes
    ----------
    joints : dict of int to str
        Names of the joints by the numbers of their columns.
    units : dict of int to str
        Units of these, and of the times, where they are written.
    times : list of int
        Numbers of the columns of times.
    others : list of str
        Headings of columns that hold something else.
    """

    joints: dict[int, str]
    units: dict[int, str]
    times: list[int]
    others: list[str]

    def per_unit(self, column: int) -> float:
        """Return how many of a column's units make one in SI."""
        unit = self.units.get(column, "")
        known = UNITS["s"][1] if column in self.times else _PER_UNIT
        return known.get(unit, 1.0)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the joints; none of a table without, or of the one joint of `angle_deg`."""
        names = tuple(self.joints.values())
        return names if any(names) else ()

    @property
    def unit_words(self) -> list[str]:
        """A remark on the units of the joints, where they are written."""
        by_unit = dict[str, list[str]]()
        for at, unit in self.units.items():
            if at in self.joints:
                by_unit.setdefault(unit, []).append(self.joints[at] or "the joint")
        if len(by_unit) == 1 and len(self.units) >= len(self.joints):
            return [f"positions of the table are read in {next(iter(by_unit))}"]
        read = [f"{', '.join(names)} in {unit}" for unit, names in by_unit.items()]
        return [f"positions of the table are read of {'; '.join(read)}"] if read else []


def read_headings(cells: Sequence[str]) -> Headings:
    """Take headings apart: elbow, elbow_deg, elbow [deg], elbow_angle_deg, time, time_ms.

    A name may end like a unit: behind an underscore is one only where all columns have one. In a
    table of `export` only angles and positions are those of joints.
    """
    names = [cell.strip() for cell in cells]
    times = [number for number, name in enumerate(names) if _is_time(name)]
    units = {at: unit for at in times if (unit := _split(names[at], UNITS["s"][1])[1])}
    columns = [number for number in range(len(names)) if number not in times]
    split = {number: _split(names[number], _PER_UNIT) for number in columns}
    exported = {
        number: (name.rpartition("_")[0], unit)
        for number, (name, unit) in split.items()
        if name.rpartition("_")[2] in _AS_EXPORTED and unit
    }
    if not exported and not all(unit for _, unit in split.values()):
        split = {
            number: (names[number], "") if _BEHIND.fullmatch(names[number]) else entry
            for number, entry in split.items()
        }
    read = exported or split
    return Headings(
        {number: name for number, (name, _) in read.items()},
        units | {number: unit for number, (_, unit) in read.items() if unit},
        times,
        [names[number] for number in columns if number not in read],
    )


def cell_value(cell: str) -> tuple[float, bool]:
    """Read a cell as a number, or one in SI units if it has a unit of its own: then True."""
    if is_number(cell):
        return float(cell), False
    for unit in ("rad", "m", "s"):
        try:
            return parse_quantity(cell, unit, "a position"), True
        except ValueError:
            continue
    raise ValueError(f"could not convert string to float: {cell.strip()!r}")


def _is_time(name: str) -> bool:
    return re.split(r"[\s_(\[]", name.lower(), maxsplit=1)[0] in ("t", "time")


def _split(name: str, known: Collection[str]) -> tuple[str, str]:
    """The name and the unit of a heading; the unit is empty where it has none that is known."""
    for form in (_IN_BRACKETS, _BEHIND):
        match = form.fullmatch(name)
        if match and match[2] in known:
            return match[1], match[2]
    return name, ""
