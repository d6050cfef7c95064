"""What is recomputed as pictures: the paper's figures, all systems, multiples of the floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from statistics import median

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator
from quietarm.ocp import Plan
from quietarm.studies.display.words import move_of, title_of
from quietarm.studies.figures import BLUE, GREEN, PAPER_PANELS, RED, Line, motion_figure
from quietarm.studies.figures.axes import TITLE, axes_or_new, new_figure
from quietarm.studies.figures.looks import COLOURS, ORANGE, PINK
from quietarm.studies.paper import CONDITIONS, EARLIER, Case
from quietarm.studies.reproduction.recompute import Reproduction, RowResult
from quietarm.studies.reproduction.searches import (
    COMPARED_TERMS,
    Input,
    input_name,
    own_search,
)
from quietarm.studies.reproduction.systems import (
    CYCLOID,
    FLOOR,
    FREQUENCY_ERROR,
    System,
    Systems,
)
from quietarm.studies.reproduction.tables import SERIES, Multiples, multiples

_STYLES = {2: (GREEN, "-."), 4: (RED, "--"), 6: (BLUE, "-")}  # hues of the paper's Figs 2 and 5
_SHADE = "0.955"
"""Of every other band."""


def _tick(ax: Axes, ticks: Mapping[float, float]) -> None:
    """Mark an axis at these places, each with its number, where they are within what is drawn."""
    low, high = ax.get_xlim()
    shown = {place: number for place, number in ticks.items() if low <= place <= high}
    ax.xaxis.set_major_locator(FixedLocator(list(shown)))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_xticklabels([f"{number:g}" for number in shown.values()])
    ax.grid(axis="x", alpha=0.35)
    ax.tick_params(axis="y", length=0)


def _legend(figure: Figure, handles: Sequence[Line2D], columns: int) -> None:
    figure.legend(
        handles=handles, loc="outside lower center", ncols=columns, frameon=False, fontsize=9
    )


# The paper's figures


def redrawn(result: Reproduction, condition: Case, title: str) -> Figure:
    """Fig. 2 or 5 from the printed coefficients, with what search and gradient find for N = 6."""
    lines = [Line(result.cycloids[condition], "cycloid", "black")]
    for terms, (colour, style) in _STYLES.items():
        lines += _of_paper(result.result(condition, terms), colour, style)
    lines += _by_search(result, condition, COMPARED_TERMS, PINK)
    gradient = result.more_terms[condition, COMPARED_TERMS, True]
    lines.append(Line(gradient, "gradient, N = 6, same box", ORANGE, (0, (7, 2))))
    return motion_figure(lines, title, PAPER_PANELS)


def against_earlier(result: Reproduction, condition: Case, title: str) -> Figure:
    """Fig. 3 or Fig. 6: the paper's coefficients over the earlier study's profile as read here."""
    reference, name = EARLIER[condition.task.plant.name]
    row = next(r for r in result.rows if r.row.condition == condition and r.earlier)
    assert isinstance(row.earlier, Plan)
    return motion_figure(
        [
            *_by_search(result, condition, name, ORANGE),
            Line(row.earlier, f"{name} of ref. [{reference}] as read here, by gradient", RED, ":"),
            *_of_paper(row, BLUE, "-"),
            *_by_search(result, condition, COMPARED_TERMS, PINK),
            Line(row.in_box, "gradient, N = 6, the paper's box", GREEN, (0, (7, 2))),
        ],
        title,
        PAPER_PANELS,
    )


def _by_search(result: Reproduction, case: Case, which: Input, colour: str) -> list[Line]:
    """The middle seed of the paper's search; none where that did not come near enough."""
    found = result.experiment[case, which].middle
    label = f"{input_name(which)}, {own_search(case).label}"
    return [] if found is None else [Line(found, label, colour, "--")]


def _of_paper(row: RowResult, colour: str, style: str) -> list[Line]:
    """The paper's own coefficients, where it prints them."""
    label = f"paper, N = {row.row.terms}{', a_5 mended' if row.mended else ''}"
    plan = row.mended_or_printed
    return [] if plan is None else [Line(plan, label, colour, style)]


# Side by side

_MARKS = "os^Dv<>"
_SPREAD = 0.62
"""Share of a row's height over which the dots of the moves are spread, so that all are seen."""


_Move = Mapping[str, System]
"""The systems on a move, by their names."""


def _over(value: float | None, unit: float | None) -> float | None:
    return None if value is None or not unit else value / unit


def _of_cycloid(value: float | None, move: _Move) -> float | None:
    """A residual in per cent of the plain cycloid's."""
    left = move[CYCLOID].residual
    return _over(value, left and left / 100)


_PANELS: tuple[tuple[str, Sequence[float], Callable[[System, _Move], float | None]], ...] = (
    ("energy\n[times the floor]", (1, 1.5, 2, 3, 5, 10),
     lambda found, move: _over(found.energy, move[FLOOR].energy)),
    ("residual\n[% of the plain cycloid's]", (0, 25, 50, 75, 100),
     lambda found, move: _of_cycloid(found.residual, move)),
    (f"residual, frequency {100 * FREQUENCY_ERROR:g} % wrong\n[% of the plain cycloid's]",
     (0, 50, 100, 150, 200, 250, 300),
     lambda found, move: _of_cycloid(found.wrong_residual, move)),
    ("peak acceleration\n[times the plain cycloid's]", (1, 10, 100, 1000, 10000),
     lambda found, move: _over(found.peak_acceleration, move[CYCLOID].peak_acceleration)),
    ("time to find\n[s]", (0.1, 1, 10, 100), lambda found, move: found.seconds),
)  # fmt: skip
"""Figures of merit: title, ticks, and the figure of a system in units of others on its move."""


def systems_figure(systems: Systems) -> Figure:
    """A row for each system and a dot for each move; a panel for each figure of merit."""
    figure = new_figure(13, 7.4)
    panels = list(figure.subplots(1, len(_PANELS), sharey=True))
    moves = [{found.name: found for found in every} for every in systems.values()]
    plants = list(dict.fromkeys(case.task.plant.name for case in systems))
    dots: list[Line2D] = []
    for case in systems:  # a colour for each plant, and a mark for each of its moves
        colour = COLOURS[plants.index(case.task.plant.name)]
        mark = _MARKS[sum(dot.get_color() == colour for dot in dots)]
        dots.append(Line2D([], [], ls="", marker=mark, color=colour, label=title_of(case.task)))
    for (title, ticks, of), ax in zip(_PANELS, panels, strict=True):
        _draw_dots(ax, of, moves, dots)
        if ticks[0] > 0:
            ax.set_xscale("log")
        else:
            ax.set_xlim(left=-4)
        _tick(ax, {tick: tick for tick in ticks})
        ax.set_title(title, **TITLE)
    labels: list[str] = []
    for name in moves[0]:
        having = sum(move[name].energy is not None for move in moves)
        some = f"\n({having} of {len(moves)} moves)" if having < len(moves) else ""
        labels.append(f"{name}{some}")
    panels[0].set_yticks(range(len(labels)), labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    middle = Line2D([], [], ls="", marker="|", color="black", label="median", ms=14, mew=2)
    _legend(figure, [*dots, middle], 4)
    figure.suptitle("Every system on the same moves: further left is better", fontsize=12)
    return figure


def _draw_dots(
    ax: Axes,
    of: Callable[[System, _Move], float | None],
    moves: Sequence[_Move],
    dots: Sequence[Line2D],
) -> None:
    """The dots of every system in the looks of the moves, and a line at their median."""
    for row, name in enumerate(moves[0]):
        if row % 2 == 0:
            ax.axhspan(row - 0.5, row + 0.5, color=_SHADE, zorder=0)
        drawn: list[float] = []
        for lane, (move, dot) in enumerate(zip(moves, dots, strict=True)):
            value = of(move[name], move)
            if value is not None:
                drawn.append(value)
                height = row + _SPREAD * (lane / max(1, len(moves) - 1) - 0.5)
                ax.plot(value, height, marker=dot.get_marker(), color=dot.get_color(),
                        markersize=5, zorder=3, clip_on=False)  # fmt: skip
        if drawn:
            middle, half = median(drawn), _SPREAD / 2 + 0.08
            ax.plot([middle] * 2, [row - half, row + half], color="black", lw=2, zorder=2)


# The floor

_COLOURS = dict(zip(SERIES, ("black", GREEN, PINK, BLUE, RED), strict=True))
_MULTIPLES = (1.02, 1.05, 1.1, 1.2, 1.5, 2, 3, 4, 6, 10)
_MARGIN = 1.1
_BAND = len(SERIES) - 1 + 2 * _MARGIN


def floor_dots(result: Reproduction) -> Figure:
    """Every multiple of the floor as a dot with its number of terms in it; bands of conditions.

    The distance above the floor is drawn on a logarithmic scale, which separates the dots near the
    floor; the axis is marked in multiples.
    """
    figure = new_figure(10, 10.4)
    ax = axes_or_new(figure.subplots())
    ax.grid(visible=False, axis="y")
    labels: list[str] = []
    for place, condition in enumerate(CONDITIONS):
        top = place * _BAND
        if place % 2 == 0:
            ax.axhspan(top - _MARGIN, top - _MARGIN + _BAND, color=_SHADE, zorder=0)
        found, task = multiples(result, condition), condition.task
        for lane, series in enumerate(SERIES):
            _draw_lane(ax, top + lane, series, found)
        floor = f"floor {result.floors[condition].energy:.4g} J"
        labels.append(f"{task.plant.name}\n{move_of(task)}\n{floor}")
    middle = (len(SERIES) - 1) / 2
    ax.set_yticks([place * _BAND + middle for place in range(len(CONDITIONS))], labels)
    ax.set_ylim(len(CONDITIONS) * _BAND - _MARGIN, -_MARGIN)
    ax.set_xscale("log")
    _tick(ax, {multiple - 1: multiple for multiple in _MULTIPLES})
    ax.set_xlabel(
        "times the floor (distance above it on a logarithmic scale); in the dots: terms N"
    )
    ax.set_title(
        "Energy as a multiple of the least that any joint motion needs, at rest on arrival",
        loc="left",
        fontsize=11,
    )
    handles = [
        Line2D([], [], marker="o", color=_COLOURS[series], label=series, markersize=8)
        for series in SERIES
    ]
    _legend(figure, handles, len(SERIES))
    return figure


def _draw_lane(ax: Axes, height: float, series: str, found: Multiples) -> None:
    """The dots of one series, a line through them, and a bar between the quartiles of seeds."""
    above = {n: of for (name, n), of in found.items() if name == series and of[0] > 1}
    colour = _COLOURS[series]
    ax.plot(
        [of[0] - 1 for of in above.values()], [height] * len(above),
        color=colour, linewidth=1.2, alpha=0.5, zorder=2,
    )  # fmt: skip
    for terms, (middle, lower, upper) in above.items():
        if upper > lower > 1:
            ax.plot(
                [lower - 1, upper - 1], [height] * 2,
                color=colour, linewidth=4, alpha=0.35, solid_capstyle="butt", zorder=2,
            )  # fmt: skip
        # The dot of the most terms lies uppermost where dots meet.
        ax.plot(
            middle - 1, height, "o",
            color=colour, markersize=10.5, markeredgecolor="white", zorder=3 + terms,
        )  # fmt: skip
        ax.text(
            middle - 1, height + 0.03, str(terms),
            color="white", fontsize=6.5, ha="center", va="center", zorder=3.5 + terms,
        )  # fmt: skip
