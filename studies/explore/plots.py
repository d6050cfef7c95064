"""The plots of the page: the structure in motion, the front, robustness, quantities over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from bokeh.document import Document
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, Range1d, ScaleBar
from bokeh.plotting import figure
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Plant
from quietarm.ocp import Plan, evaluate_coefficients, evaluate_robustness
from quietarm.studies.explore.move import Explored
from quietarm.views.pictures.axes import residual_label
from quietarm.views.pictures.grammar import (
    AFTER_ARRIVAL,
    ARRIVAL,
    FAINT,
    INK,
    LIMIT,
    MEANINGS,
    Look,
    looks,
)
from quietarm.views.pictures.meaning import meaning_of
from quietarm.views.pictures.motion import Line, curves, heading, limits_in_sight
from quietarm.views.pictures.structure import Structure, structures_of
from quietarm.views.report.words import residual_words
from quietarm.views.tips import tip_scale

_DASHES = {"-": "solid", "--": "dashed", ":": "dotted"}
"""The dashes of the grammar of pictures, as bokeh calls them."""
_ROOM = 0.08
"""Beyond the points of a front, as a share of their range."""
PANELS = ("deflection", "angle", "torque", "speed", "acceleration", "jerk")
FRAMES = 25
"""A second."""
FREQUENCY = 0.2
"""Largest error of the frequency that is looked at."""
_PLAY = Path(__file__).with_name("play.js").read_text()
"""The frame of the moment, and the last one for a second."""
_GHOST_TRAIL = (5.0, 0.35)
_TRAIL_OF_THIS = (1.8, 0.9)
"""Width and opacity: the ghost's is wide and pale, so that both are seen where they coincide."""
Rows = list[tuple[Any, ...]]
"""Of a source, in the order of its columns."""
_CURVE = ("xs", "ys", "colour", "dash", "alpha", "wide")
_TRAIL = ("xs", "ys", "colour", "wide", "alpha")
_BODY = ("xs", "ys", "colour", "width")
_POINT = ("x", "y")
_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "film": (*_BODY, "frames", "words"), "paths": _TRAIL, "corners": _POINT,
    "points": _POINT, "here": _POINT, "cycloid": _POINT,
    **dict.fromkeys(("robustness", *PANELS), _CURVE),
}  # fmt: skip
"""Of the source of everything that is drawn."""
_ON_FRONT = ("points", "here", "cycloid")
"""Sources of what lies on the plane of the front."""


class Plots:
    """All plots by name; `pick` is told the number of a point of the front that is clicked."""

    def __init__(self, document: Document, plant: Plant, pick: Callable[[int], None]) -> None:
        self._sources = {
            name: ColumnDataSource({column: [] for column in of}) for name, of in _COLUMNS.items()
        }
        shown = tip_scale(plant.tip_unit)[0]
        below = "time [s]  (dashed: arrival)"
        titles = {
            "robustness": (f"residual over the frequency error [{shown}]", "frequency error [%]"),
            **{name: (heading(name, plant.joint, plant.tip_unit), below) for name in PANELS},
        }
        self._front = self._tradeoff(pick)
        panels = [self._panel(name, *words) for name, words in titles.items()]
        self.roots = [self._stage(document), self._front, *panels]

    def show(self, explored: Explored) -> None:
        """Show another motion in all plots."""
        self.entitle_front("press Front for the least energy of each residual")
        if explored.front:
            self.entitle_front("front: click near it for a motion of it")
        colour = MEANINGS[_meaning(explored.plan)].colour
        line, marks, _, here = self._front.renderers
        line.glyph.line_color = colour
        marks.glyph.update(line_color=colour, fill_color=colour)
        here.glyph.line_color = INK if explored.front else colour
        self._front.xaxis.axis_label = residual_label(
            explored.task.plant.tip_unit, explored.task.residual_window
        )
        for name, rows in _drawn(explored).items():
            table = pd.DataFrame(rows, columns=_COLUMNS[name])
            self._sources[name].data = table.to_dict("list")
        zero = [] if explored.front else [0.0]  # few points alone would say nothing of their size
        for at, direction in zip(_POINT, (self._front.x_range, self._front.y_range)):
            drawn = [
                *zero,
                *(value for name in _ON_FRONT for value in self._sources[name].data[at]),
            ]
            low = min(drawn)
            high = max(drawn)
            room = _ROOM * (high - low) or 1.0
            direction.update(start=low - room, end=high + room)

    def entitle_front(self, words: str) -> None:
        """Say above the front what can be done there, or how far it is."""
        self._front.title.text = words

    def _stage(self, document: Document) -> Any:
        """The structure, which the browser plays by itself."""
        higher = 280
        plot: Any = figure(name="stage", title=" ", tools="", height=higher, match_aspect=True)
        plot.grid.visible = plot.axis.visible = False
        shown = ColumnDataSource({name: [] for name in _BODY})
        room = plot.scatter(*_POINT, source=self._sources["corners"], alpha=0)
        plot.x_range, plot.y_range = (
            DataRange1d(renderers=[room], range_padding=0.2) for _ in _POINT
        )
        plot.add_layout(ScaleBar(range=plot.x_range, unit="m"), "below")  # where nothing crosses it
        plot.multi_line("xs", "ys", source=self._sources["paths"], color="colour",
                        line_width="wide", line_alpha="alpha")  # fmt: skip
        plot.multi_line("xs", "ys", source=shown, color="colour", line_width="width",
                        line_cap="round", line_join="round")  # fmt: skip
        shown.syncable = plot.title.syncable = False  # frames are no news for the server
        play = {"film": self._sources["film"], "shown": shown, "title": plot.title, "rate": FRAMES}
        document.js_on_event("document_ready", CustomJS(args=play, code=_PLAY))
        plot.tags = [play["film"]]  # else it would be no part of the document
        return plot

    def _tradeoff(self, pick: Callable[[int], None]) -> Any:
        """The front, and where the motion in hand lies."""
        ranges: dict[str, Any] = {
            "x_range": Range1d(start=0.0, end=1.0),
            "y_range": Range1d(start=0.0, end=1.0),
        }
        plot: Any = figure(name="front", tools="", x_axis_label=" ",
                           y_axis_label="energy F2 [J]", **ranges)  # fmt: skip
        points, here, cycloid = (self._sources[name] for name in _ON_FRONT)

        def tapped(event: Tap) -> None:
            drawn = [pd.DataFrame(source.data) for source in (points, here, cycloid)]
            nearest = _nearest(drawn, (float(event.x or 0.0), float(event.y or 0.0)))
            if nearest is not None:
                pick(nearest)

        plot.on_event(Tap, tapped)
        plot.line(*_POINT, source=points)
        plot.scatter(*_POINT, source=points, size=7)
        plot.scatter(*_POINT, source=cycloid, size=9, marker="square",
                     color=MEANINGS["plain cycloid"].colour)  # fmt: skip
        plot.scatter(*_POINT, source=here, fill_alpha=0, line_color=INK, size=17, line_width=2.5,
                     level="overlay")  # fmt: skip
        return plot

    def _panel(self, name: str, title: str, below: str) -> Any:
        """Curves over one axis."""
        plot: Any = figure(name=name, title=title, tools="", x_axis_label=below)
        plot.multi_line("xs", "ys", source=self._sources[name], line_color="colour",
                        line_dash="dash", line_width="wide", line_alpha="alpha")  # fmt: skip
        return plot


def _nearest(drawn: Sequence[pd.DataFrame], clicked: tuple[float, float]) -> int | None:
    """The number of the front's point, the first of what is drawn, that is nearest to a place."""
    points, *_ = drawn
    if points.empty:
        return None
    spans = np.ptp(pd.concat(drawn).to_numpy(float), axis=0)
    away = (points.to_numpy(float) - clicked) / np.where(spans > 0, spans, 1.0)
    return int((away**2).sum(axis=1).argmin())


def _drawn(explored: Explored) -> dict[str, Rows]:
    """Rows of every source: the motion in hand, over the plain cycloid and the one that is kept."""
    plan = explored.plan
    front = explored.front.points if explored.front else ()
    cycloid = evaluate_coefficients(plan.task, [])
    motions = [cycloid, plan, *([explored.kept] if explored.kept else [])]
    meanings = ["plain cycloid", _meaning(plan), _meaning(plan)]
    lines = [
        Line(motion, "", look.colour, _DASHES[str(look.dash)])
        for motion, look in zip(motions, looks(meanings))
    ]
    ghost = lines[0]
    drawn = lines[1]
    scale = tip_scale(plan.task.plant.tip_unit)[1]
    points = [(scale * point.residual, point.energy) for point in front]
    rows = {
        "points": points,
        "here": [(scale * plan.residual, plan.energy)],
        "cycloid": [(scale * cycloid.residual, cycloid.energy)],
        "robustness": _robustness(plan, drawn.colour),
    }
    in_order = [ghost, *lines[2:], drawn]  # this motion above the others
    return rows | _film(drawn, ghost) | {name: _quantity(in_order, name) for name in PANELS}


def _meaning(plan: Plan) -> str:
    """The look of the motion in hand: that of a plan, also where it is not one yet."""
    meaning = meaning_of(plan)
    return meaning if meaning == "robust plan" else "plan"


def _quantity(lines: list[Line], name: str) -> Rows:
    """A quantity of motions; the limits that these come near, and the arrival of the last one.

    First all motions until they arrive, then, lighter, all after that.
    """
    # of a curve: on a panel a third of a screen wide their corners cannot be seen
    points = 200
    moving = Rows()
    after = Rows()
    reach = [np.zeros(1)]
    end = lines[-1].plan.task.duration
    for line in lines:
        time = line.plan.trajectory.time
        arrival = int(np.searchsorted(time, line.plan.task.duration))
        some = slice(None, None, max(1, len(time) // points))
        for values in curves(line.plan, name):
            for rows, part, alpha in (
                (moving, slice(arrival + 1), 1.0),
                (after, slice(arrival, None), AFTER_ARRIVAL),
            ):
                along = _thinned(time[part], values[part], some)
                rows.append((*along, line.colour, line.style, alpha, 1.6))
            reach.append(values)
    limits = limits_in_sight(lines[-1:], name, np.concatenate(reach))
    level = [_ruled(LIMIT, [0.0, end], [limit, limit]) for limit in limits]
    all_values = np.concatenate([*reach, limits])
    arrived = _ruled(ARRIVAL, [end, end], [all_values.min(), all_values.max()])
    return [*moving, *after, *level, arrived]


def _thinned(
    time: NDArray[np.float64], values: NDArray[np.float64], some: slice
) -> tuple[list[float], list[float]]:
    """Some samples of a curve, its last one among them."""
    places = np.union1d(np.arange(len(time))[some], [len(time) - 1])
    return _plain(time[places]), _plain(values[places])


def _ruled(look: Look, xs: list[float], ys: list[float]) -> tuple[Any, ...]:
    """A straight line of a look, as a row of a panel."""
    return _plain(xs), _plain(ys), look.colour, _DASHES[str(look.dash)], 1.0, look.width


def _robustness(plan: Plan, colour: str) -> Rows:
    """The residual over the error of the frequency [%], and what is tolerated."""
    ranges = {"frequency": FREQUENCY}
    robustness = evaluate_robustness(plan.candidate, ranges, samples=1)
    scale = tip_scale(plan.task.plant.tip_unit)[1]
    (sweep,) = robustness.sweeps
    tolerated = scale * robustness.tolerated
    errors = _plain(100 * sweep.errors)
    residuals = _plain(scale * sweep.figures.residual)
    level = _ruled(LIMIT, [errors[0], errors[-1]], [tolerated, tolerated])
    return [(errors, residuals, colour, "solid", 1.0, 1.6), level]


def _film(line: Line, ghost: Line) -> dict[str, Rows]:
    """The structure of a plan from its start to the end of the residual window, all frames.

    Behind it stands that of the plain cycloid, its ghost.
    """
    plan = line.plan
    end = plan.task.duration + plan.task.residual_window
    times = np.arange(0.0, end, 1 / FRAMES)
    structure, behind = structures_of([line, ghost], times, end)
    residual = residual_words(plan.residual, plan.task.plant.tip_unit)
    residual = "at rest" if residual == "rest" else residual
    words = f"{plan.energy:.4g} J, residual: {residual}; {structure.scale_words}"
    pale = [part._replace(colour=FAINT) for part in behind.bent if part.colour != FAINT]
    parts = [(*_along(part.points), part.colour, part.width, len(times), words)
             for part in (*pale, *structure.bent)]  # fmt: skip
    corners = np.vstack([structure.corners, behind.corners])
    return {
        "film": parts,
        "corners": _plain([corners.min(axis=0), corners.max(axis=0)]),
        "paths": [*_trails(behind, _GHOST_TRAIL), *_trails(structure, _TRAIL_OF_THIS)],
    }


def _trails(structure: Structure, look: tuple[float, float]) -> Rows:
    """Where the tips go, in the colour of the motion, so wide and so opaque."""
    return [(*_along(path), structure.line.colour, *look) for path in structure.paths]


def _along(points: NDArray[np.float64]) -> tuple[Any, ...]:
    """Abscissas and ordinates of points, one after another."""
    return tuple(_plain(points[..., k].ravel()) for k in (0, 1))


def _plain(values: ArrayLike) -> Any:
    # of what is drawn, behind the point: lists are in the browser sooner than many arrays
    digits = 6
    return np.round(np.asarray(values), digits).tolist()
