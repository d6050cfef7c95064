"""What stands side by side as a picture: a row for each system, a dot for each move."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator
from quietarm.studies.display.words import title_of
from quietarm.studies.figures.axes import TITLE, new_figure
from quietarm.studies.figures.looks import COLOURS
from quietarm.studies.paper.case import Case
from quietarm.studies.reproduction.side_by_side.results import (
    CYCLOID,
    FLOOR,
    FREQUENCY_ERROR,
    System,
)
from quietarm.studies.reproduction.side_by_side.table import Systems

_MARKS = "os^Dv<>"
_SPREAD = 0.62
"""Share of a row's height over which the dots of the moves are spread, so that all are seen."""


@dataclass(frozen=True)
class _Panel:
    """One figure of merit, in units of what some system has on the same move."""

    title: str
    of: Callable[[System], float | None]
    unit: Callable[[System], float | None]
    of_system: str
    ticks: Sequence[float]
    logarithmic: bool = False


def _residual(found: System) -> float | None:
    return found.motion and 100 * found.motion.residual


def _wrong_residual(found: System) -> float | None:
    return found.wrong_residual and 100 * found.wrong_residual


def _whole_residual(found: System) -> float | None:
    return found.motion and found.motion.residual


def _acceleration(found: System) -> float | None:
    return found.motion and found.motion.peak_acceleration


def _energy(found: System) -> float | None:
    return found.energy


_PANELS = (
    _Panel(
        "energy\n[times the floor]",
        _energy, _energy, FLOOR, (1, 1.5, 2, 3, 5, 10), logarithmic=True,
    ),
    _Panel(
        "residual\n[% of the plain cycloid's]",
        _residual, _whole_residual, CYCLOID, (0, 25, 50, 75, 100),
    ),
    _Panel(
        f"residual, frequency {100 * FREQUENCY_ERROR:g} % wrong\n[% of the plain cycloid's]",
        _wrong_residual, _whole_residual, CYCLOID, (0, 50, 100, 150, 200, 250, 300),
    ),
    _Panel(
        "peak acceleration\n[times the plain cycloid's]",
        _acceleration, _acceleration, CYCLOID, (1, 10, 100, 1000, 10000), logarithmic=True,
    ),
    _Panel(
        "time to find\n[s]",
        lambda found: found.seconds, lambda found: 1.0, FLOOR, (0.1, 1, 10, 100), logarithmic=True,
    ),
)  # fmt: skip


def systems_figure(systems: Systems) -> Figure:
    """The picture of `quietarm reproduce`: a panel for each figure of merit, and the legend."""
    figure = new_figure(16, 7.4)
    panels = list(figure.subplots(1, len(_PANELS), sharey=True))
    looks = _looks(systems)
    for panel, ax in zip(_PANELS, panels, strict=True):
        _draw(panel, systems, looks, ax)
    names = _names(systems)
    panels[0].set_yticks(range(len(names)), [_label(name, systems) for name in names])
    panels[0].set_ylim(len(names) - 0.5, -0.5)
    handles = [
        Line2D([], [], linestyle="", marker=mark, color=colour, label=title_of(case.task))
        for case, (colour, mark) in looks.items()
    ]
    handles.append(Line2D([], [], linestyle="", marker="|", color="black", label="median",
                          markersize=14, markeredgewidth=2))  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    figure.suptitle("Every system on the same moves: further left is better", fontsize=12)
    return figure


def _names(systems: Systems) -> list[str]:
    return list(dict.fromkeys(found.name for every in systems.values() for found in every))


def _label(name: str, systems: Systems) -> str:
    """A system's name, and on how many of the moves it has an energy where not on all."""
    having = [named[name].energy is not None for named in map(_named, systems.values())]
    return name if all(having) else f"{name}\n({sum(having)} of {len(having)} moves)"


def _named(every: Sequence[System]) -> Mapping[str, System]:
    return {found.name: found for found in every}


def _looks(systems: Systems) -> dict[Case, tuple[str, str]]:
    """A colour for each plant, and a mark for each of its moves."""
    plants = list(dict.fromkeys(case.task.plant.name for case in systems))
    looks: dict[Case, tuple[str, str]] = {}
    for case in systems:
        plant = case.task.plant.name
        before = sum(other.task.plant.name == plant for other in looks)
        looks[case] = COLOURS[plants.index(plant)], _MARKS[before]
    return looks


def _draw(panel: _Panel, systems: Systems, looks: Mapping[Case, tuple[str, str]], ax: Axes) -> None:
    names = _names(systems)
    for row, name in enumerate(names):
        if row % 2 == 0:
            ax.axhspan(row - 0.5, row + 0.5, color="0.955", zorder=0)
        drawn: list[float] = []
        for lane, (case, every) in enumerate(systems.items()):
            named = _named(every)
            value, unit = panel.of(named[name]), panel.unit(named[panel.of_system])
            if value is None or not unit:
                continue
            drawn.append(value / unit)
            colour, mark = looks[case]
            height = row + _SPREAD * (lane / max(1, len(systems) - 1) - 0.5)
            ax.plot(value / unit, height, mark, color=colour, markersize=5, zorder=3, clip_on=False)
        if drawn:
            middle, half = median(drawn), _SPREAD / 2 + 0.08
            ax.plot([middle] * 2, [row - half, row + half], color="black", linewidth=2, zorder=2)
    _mark(panel, ax)


def _mark(panel: _Panel, ax: Axes) -> None:
    """Ticks within what is drawn, and the title."""
    if panel.logarithmic:
        ax.set_xscale("log")
    else:
        ax.set_xlim(left=-4)
    low, high = ax.get_xlim()
    shown = [tick for tick in panel.ticks if low <= tick <= high]
    ax.xaxis.set_major_locator(FixedLocator(shown))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_xticklabels([f"{tick:g}" for tick in shown])
    ax.grid(axis="x", alpha=0.35)
    ax.tick_params(axis="y", length=0)
    ax.set_title(panel.title, **TITLE)
