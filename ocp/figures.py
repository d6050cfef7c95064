"""Figures of a motion: one table, which reports, notebooks, pages, tables and files read.

An entry says what a figure is called, its unit, and how it follows from a motion that CVODES has
judged. One's own, by `add_figure`, stands wherever those of quietarm do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models import Plant
from quietarm.models.dimensions import JOULE, SECOND, TIP, WATT, WAY, Unit, Words
from quietarm.models.joint_motion import MIXED
from quietarm.models.plant_file import note_added
from quietarm.ocp.checks import instance, quoted, takes, unknown, words_of_error
from quietarm.ocp.errors import QuietarmError
from quietarm.ocp.limits import (
    PAGE,
    PLACES,
    QUANTITIES,
    REPORT,
    RESIDUAL,
    Limit,
    Quantity,
)

if TYPE_CHECKING:
    from quietarm.ocp.judged_motion import JudgedMotion
    from quietarm.ocp.task import PointToPoint

ENERGY = "energy"
ACTS_AFTER = "acts_after"


def _by_every(_: PointToPoint) -> bool:
    return True


@dataclass(frozen=True)
class Figure:
    """A figure of a motion.

    Attributes
    ----------
    name : str
        Its name, such as ``rms_torque``.
    unit : Unit
        Its SI unit, such as `EFFORT`.
    label : Words
        What it is, where the joint turns and where it slides.
    of : callable
        The figure of a `JudgedMotion`, a motion that CVODES has judged; where a motion has none,
        infinite or no number.
    symbol : str
        Its symbol, such as F1.
    digits : int
        How many digits are shown.
    shown : frozenset of str
        Some of `PLACES`: where it stands.
    agreement : float
        The difference from what a file states within which it is always the same [its unit].
    quantity : str
        The quantity whose peak it is; empty of others.
    asked_by : callable
        Whether a task asks for it: tables of other tasks have no place for it. By default all do.
    """

    example: ClassVar[str] = (
        "a figure, such as Figure('rms_torque', EFFORT, Words('RMS torque'), rms('torque')), with "
        "unit and words of quietarm.models.dimensions"
    )

    name: str
    unit: Unit
    label: Words
    of: Callable[[JudgedMotion], float]
    symbol: str = ""
    digits: int = 4
    shown: frozenset[str] = PLACES
    agreement: float = 0.0
    quantity: str = ""
    asked_by: Callable[[PointToPoint], bool] = _by_every

    def __post_init__(self) -> None:
        instance("unit", self.unit, Unit)
        instance("label", self.label, Words)

    def value(self, candidate: JudgedMotion) -> float:
        """The figure of a motion; ValueError where a function of one's own gives no number."""
        if self.name not in _added:
            return self.of(candidate)
        try:
            return float(self.of(candidate))
        except QuietarmError:
            raise
        except Exception as error:  # of a function of one's own
            raise ValueError(
                f"the figure {self.name!r} fails ({words_of_error(error)}); give a function of a "
                "JudgedMotion that returns a number"
            ) from None

    def unit_on(self, plant: Plant) -> str:
        """Return the text of its unit for a plant."""
        return self.unit.of(plant.joint, plant.tip_unit)

    def label_on(self, plant: Plant) -> str:
        """Return its label for a plant."""
        return self.label.of(plant.joint)

    def column_on(self, plant: Plant) -> str:
        """Return the heading of its column: its name with its unit."""
        unit = self.unit.on(plant.joint, plant.tip_unit)
        return f"{self.name}_{unit.in_heading}" if unit.powers else self.name

    def words(self, value: float, plant: Plant, drawn: bool = False) -> str:
        """A value with its unit; as it is `drawn` with powers raised."""
        unit = self.unit.on(plant.joint, plant.tip_unit)
        return f"{value:.{self.digits}g} {unit.drawn if drawn else unit}".rstrip()


def peak_figure(quantity: Quantity) -> Figure:
    """The largest absolute value of a quantity during the move, as a figure."""

    def peak(candidate: JudgedMotion) -> float:
        least, largest = candidate.range_of(QUANTITIES.get(quantity.name, quantity))
        return max(-least, largest)

    return Figure(
        quantity.peak,
        quantity.unit,
        quantity.words.within("peak {}"),
        peak,
        shown=quantity.shown,
        quantity=quantity.name,
    )


@interruptible
def rms(quantity: str) -> Callable[[JudgedMotion], float]:
    """Return a function for `Figure`: a quantity's root mean square over the move.

    For several joints it is the largest. A motion whose joints turn and slide has none, since
    newtons and newton metres have no largest. ValueError if there is no such quantity.
    """
    _refuse_unknown(quantity)

    def value(candidate: JudgedMotion) -> float:
        if _is_of_several_units(candidate, quantity):
            return math.nan
        rows = candidate.values_of(QUANTITIES[quantity])
        return float(np.sqrt(rows**2 @ candidate.weights / candidate.task.duration).max())

    return value


@interruptible
def final(quantity: str) -> Callable[[JudgedMotion], float]:
    """Return a function for `Figure`: a quantity's largest absolute value on arrival.

    A motion whose joints turn and slide has none. ValueError if there is no such quantity.
    """
    _refuse_unknown(quantity)

    def value(candidate: JudgedMotion) -> float:
        if _is_of_several_units(candidate, quantity):
            return math.nan
        return float(np.abs(candidate.values_of(QUANTITIES[quantity])[:, -1]).max())

    return value


def _is_of_several_units(candidate: JudgedMotion, quantity: str) -> bool:
    """Return whether a quantity of this motion has different units for different joints."""
    return candidate.task.plant.joint == MIXED and QUANTITIES[quantity].of_joints


def _refuse_unknown(quantity: str) -> None:
    if quantity not in QUANTITIES:
        raise ValueError(unknown("quantity", quantity, QUANTITIES))


def _peak_power(candidate: JudgedMotion) -> float:
    return candidate.peak_of_rows([candidate.moving.power])


_FIRST = (
    Figure(
        RESIDUAL,
        TIP,
        Words("residual"),
        lambda candidate: candidate.residual,
        symbol="F1",
    ),
    Figure(ENERGY, JOULE, Words("energy"), lambda candidate: candidate.energy, symbol="F2"),
    Figure(
        "net_work",
        JOULE,
        Words("net work"),
        lambda candidate: candidate.net_work,
        shown=frozenset(),
    ),
)
_ACTS_AFTER = Figure(
    ACTS_AFTER,
    SECOND,
    Words("acts after"),
    lambda candidate: candidate.acts_after,
    agreement=1e-6,
    asked_by=lambda task: task.band is not None,
)
_POWER = Figure("peak_power", WATT, Words("peak power"), _peak_power, shown=frozenset({PAGE}))
OTHERS = (
    Figure(
        "overshoot",
        WAY,
        Words("overshoot"),
        lambda candidate: candidate.overshoot,
        digits=3,
        shown=frozenset({REPORT}),
    ),
)
"""Figures that stand after the peaks: one more of quietarm's own is an entry here."""


_added: dict[str, Figure] = {}
"""Figures of the user's own, by name."""


class _Table(Mapping[str, Figure]):
    """The figures by name: objectives, peaks of all quantities, others, one's own."""

    def __getitem__(self, name: str) -> Figure:
        return self._entries()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries())

    def __len__(self) -> int:
        return len(self._entries())

    def _entries(self) -> dict[str, Figure]:
        torque, *peaks = map(peak_figure, QUANTITIES.values())
        figures = (*_FIRST, _ACTS_AFTER, torque, _POWER, *peaks, *OTHERS, *_added.values())
        return {figure.name: figure for figure in figures}


FIGURES: Mapping[str, Figure] = _Table()
"""Every figure by its name: a new one is an entry of `OTHERS`, or `add_figure` in a user's file."""


@takes(figure=Figure)
def add_figure(figure: Figure) -> Figure:
    """Make a figure of one's own known: to reports, notebooks, pages, tables, captions and files.

    A file of one's own, as of ``--plant-file``, calls it. An entry of the same name that was added
    before is replaced. ValueError where the name is taken, or is none of Python.
    """
    name = figure.name
    if name in FIGURES and name not in _added:
        raise ValueError(f"the figure {name!r} is quietarm's own; give yours another name")
    if not name.isidentifier():
        raise ValueError(
            f"the name of a figure is {quoted(name)}; give letters, digits and _, such as "
            "rms_torque"
        )
    _added[name] = figure
    note_added(figure)
    return figure


@takes()
def remove_figure(name: str) -> None:
    """Forget a figure that was added, as at the end of a test; nothing where there is none."""
    _added.pop(name, None)


def added_figures() -> list[Figure]:
    """Return the figures of the user's own, those that `add_figure` made known."""
    return list(_added.values())


def figures_in(place: str, task: PointToPoint | None = None) -> list[Figure]:
    """Return the figures that stand in one of `PLACES`, in the order of the table.

    Those that a task asks for; without a task all.
    """
    figures = [figure for figure in FIGURES.values() if place in figure.shown]
    return [figure for figure in figures if task is None or figure.asked_by(task)]


def further_figures(place: str, task: PointToPoint) -> list[Figure]:
    """Return the figures of a place, without residual and energy, which have words of their own."""
    return [figure for figure in figures_in(place, task) if figure.name not in (RESIDUAL, ENERGY)]


class Figures(Mapping[str, Any]):
    """Figures by name, each computed when it is first read; also as attributes.

    Of a motion there are those that it has: none of the jerk where the acceleration jumps.
    """

    def __init__(
        self, of: Mapping[str, Any] | None = None, candidate: JudgedMotion | None = None
    ) -> None:
        self._values = dict(of or {})
        self.candidate = candidate

    def __getitem__(self, name: str) -> Any:
        if name not in self._values:
            if self.candidate is None:
                raise KeyError(name)
            self._values[name] = FIGURES[name].value(self.candidate)
        if isinstance(self._values[name], float) and not math.isfinite(self._values[name]):
            raise KeyError(name)
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        names = self._values if self.candidate is None else FIGURES
        return (name for name in list(names) if name in self)

    def __len__(self) -> int:
        return len(list(iter(self)))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or (name not in self._values and name not in FIGURES):
            raise AttributeError(f"there is no figure {name!r}; there are {', '.join(FIGURES)}")
        return self.get(name)

    def __repr__(self) -> str:
        return f"Figures({dict(self)})"

    def exceeded(self, limits: Iterable[Limit], tolerance: float = 0.0) -> dict[str, float]:
        """Return what exceeds its limit by more than a share: its peak over the limit, by name."""
        ratios = {
            limit.name: limit.peak_of(self) / limit.size for limit in limits if limit.size > 0
        }
        return {name: ratio for name, ratio in ratios.items() if ratio > 1 + tolerance}

    def range_of(self, quantity: Quantity) -> tuple[float, float]:
        """Return a quantity's least and largest value, or minus and plus its peak."""
        if self.candidate is not None:
            return self.candidate.range_of(quantity)
        peak = self.peak(quantity.name)
        return -peak, peak

    def peak(self, name: str) -> float:
        """Return residual, energy, or a quantity's peak, by name: infinite where it has none."""
        figure = name if name in (RESIDUAL, ENERGY) else f"peak_{name}"
        return float(self.get(figure, math.inf))

    def take(self, rows: slice) -> Figures:
        """Return the figures of some motions, where each figure is an array over motions."""
        return Figures({name: values[rows] for name, values in self._values.items()})
