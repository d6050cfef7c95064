"""The plots of the page: the structure in motion, the front, robustness, quantities over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from bokeh.document import Document
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, ScaleBar
from bokeh.plotting import figure
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Plant
from quietarm.ocp import Plan, evaluate_coefficients, evaluate_robustness
from quietarm.studies.explore.move import Explored
from quietarm.studies.figures.axes import residual_label
from quietarm.studies.figures.grammar import BLUE, FAINT, INK, ORANGE, RED
from quietarm.studies.figures.motion import Line, curves, heading, limits_in_sight
from quietarm.studies.figures.structure import structures_of
from quietarm.studies.report.words import residual_words
from quietarm.studies.tips import tip_scale

GREY = "#9e9e9e"
GHOST = "#d3d3d3"
"""Of the plain cycloid behind the motion."""
PANELS = ("deflection", "angle", "torque", "speed", "acceleration", "jerk")
FRAMES = 25
"""A second."""
FREQUENCY = 0.2
"""Largest error of the frequency that is looked at."""
_PLAY = Path(__file__).with_name("play.js").read_text()
"""The frame of the moment, and the last one for a second."""
Rows = list[tuple[Any, ...]]
"""Of a source, in the order of its columns."""
_CURVE = ("xs", "ys", "colour", "dash")
_BODY = ("xs", "ys", "colour", "width")
_POINT = ("x", "y")
_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "film": (*_BODY, "frames", "words"), "paths": ("xs", "ys"), "corners": _POINT,
    "points": _POINT, "here": _POINT, **dict.fromkeys(("robustness", *PANELS), _CURVE),
}  # fmt: skip
"""Of the source of everything that is drawn."""


class Plots:
    """All plots by name; `pick` is told the number of a point of the front that is clicked."""

    def __init__(self, document: Document, plant: Plant, pick: Callable[[int], None]) -> None:
        self._sources = {
            name: ColumnDataSource({column: [] for column in of}) for name, of in _COLUMNS.items()
        }
        shown = tip_scale(plant.tip_unit)[0]
        below = "time [s]  (dotted: arrival)"
        titles = {
            "robustness": (f"residual over the frequency error [{shown}]", "frequency error [%]"),
            **{name: (heading(name, plant.joint, plant.tip_unit), below) for name in PANELS},
        }
        self._front = self._tradeoff(pick)
        panels = [self._panel(name, *words) for name, words in titles.items()]
        self.roots = [self._stage(document), self._front, *panels]

    def show(self, explored: Explored) -> None:
        """Show another motion in all plots."""
        no_front = "Press Front to see what each millimetre saves"
        self._front.title.text = "front (cross: this motion)" if explored.front else no_front
        self._front.axis.visible = bool(explored.front)
        self._front.xaxis.axis_label = residual_label(
            explored.task.plant.tip_unit, explored.task.residual_window
        )
        for name, rows in _drawn(explored).items():
            table = pd.DataFrame(rows, columns=_COLUMNS[name])
            self._sources[name].data = table.to_dict("list")

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
        plot.multi_line("xs", "ys", source=self._sources["paths"], color=GREY)
        plot.multi_line("xs", "ys", source=shown, color="colour", line_width="width",
                        line_cap="round", line_join="round")  # fmt: skip
        shown.syncable = plot.title.syncable = False  # frames are no news for the server
        play = {"film": self._sources["film"], "shown": shown, "title": plot.title, "rate": FRAMES}
        document.js_on_event("document_ready", CustomJS(args=play, code=_PLAY))
        plot.tags = [play["film"]]  # else it would be no part of the document
        return plot

    def _tradeoff(self, pick: Callable[[int], None]) -> Any:
        """The front, and where the motion in hand lies."""
        plot: Any = figure(name="front", tools="", x_axis_label=" ",
                           y_axis_label="energy F2 [J]")  # fmt: skip
        points = self._sources["points"]
        here = self._sources["here"]

        def tapped(event: Tap) -> None:
            drawn = pd.DataFrame(points.data), pd.DataFrame(here.data)
            nearest = _nearest(*drawn, (float(event.x or 0.0), float(event.y or 0.0)))
            if nearest is not None:
                pick(nearest)

        plot.on_event(Tap, tapped)
        plot.line(*_POINT, source=points, color=BLUE)
        plot.scatter(*_POINT, source=points, color=BLUE, size=9)
        plot.scatter(*_POINT, source=here, color=RED, marker="x", size=20, line_width=2.5,
                     level="overlay")  # fmt: skip
        return plot

    def _panel(self, name: str, title: str, below: str) -> Any:
        """Curves over one axis."""
        plot: Any = figure(name=name, title=title, tools="", x_axis_label=below)
        plot.multi_line("xs", "ys", source=self._sources[name], line_color="colour",
                        line_dash="dash", line_width=1.6)  # fmt: skip
        return plot


def _nearest(points: pd.DataFrame, here: pd.DataFrame, clicked: tuple[float, float]) -> int | None:
    """The number of the point of the front that is nearest to a place, as it is drawn."""
    if points.empty:
        return None
    spans = np.ptp(pd.concat([points, here]).to_numpy(float), axis=0)
    away = (points.to_numpy(float) - clicked) / np.where(spans > 0, spans, 1.0)
    return int((away**2).sum(axis=1).argmin())


def _drawn(explored: Explored) -> dict[str, Rows]:
    """Rows of every source: the motion in hand, over the plain cycloid and the one that is kept."""
    plan = explored.plan
    front = explored.front.points if explored.front else ()
    cycloid = evaluate_coefficients(plan.task, [])
    lines = [Line(cycloid, "", GREY, "solid"), Line(plan, "", BLUE, "solid")]
    if explored.kept:
        lines.insert(1, Line(explored.kept, "", ORANGE, "dashed"))
    scale = tip_scale(plan.task.plant.tip_unit)[1]
    points, here = (
        [(scale * point.residual, point.energy) for point in of] for of in (front, [plan])
    )
    rows = {"points": points, "here": here * bool(front), "robustness": _robustness(plan)}
    return rows | _film(lines[-1], lines[0]) | {name: _quantity(lines, name) for name in PANELS}


def _quantity(lines: list[Line], name: str) -> Rows:
    """A quantity of motions; the limits that these come near, and the arrival of the last one."""
    # of a curve: on a panel a third of a screen wide their corners cannot be seen
    points = 200
    rows = Rows()
    reach = [np.zeros(1)]
    end = lines[-1].plan.task.duration
    for line in lines:
        time = line.plan.trajectory.time
        some = slice(None, None, max(1, len(time) // points))
        for values in curves(line.plan, name):
            rows.append((_plain(time[some]), _plain(values[some]), line.colour, line.style))
            reach.append(values)
    limits = limits_in_sight(lines[-1:], name, np.concatenate(reach))
    rows += [([0.0, end], [level, level], RED, "dashed") for level in limits]
    all_residuals = np.concatenate([*reach, limits])
    return [*rows, ([end, end], _plain([all_residuals.min(), all_residuals.max()]), INK, "dotted")]


def _robustness(plan: Plan) -> Rows:
    """The residual over the error of the frequency [%], and what is tolerated."""
    ranges = {"frequency": FREQUENCY}
    robustness = evaluate_robustness(plan.candidate, ranges, samples=1)
    scale = tip_scale(plan.task.plant.tip_unit)[1]
    (sweep,) = robustness.sweeps
    tolerated = scale * robustness.tolerated
    errors = _plain(100 * sweep.errors)
    residuals = _plain(scale * sweep.figures.residual)
    level = [errors[0], errors[-1]], [tolerated, tolerated], GREY, "dashed"
    return [(errors, residuals, BLUE, "solid"), level]


def _film(line: Line, ghost: Line) -> dict[str, Rows]:
    """The structure of a plan from its start to the end of the residual window, all frames.

    Behind it stands that of the plain cycloid, its ghost.
    """
    plan = line.plan
    end = plan.task.duration + plan.task.residual_window
    times = np.arange(0.0, end, 1 / FRAMES)
    structure, behind = structures_of([line, ghost], times, end)
    residual = residual_words(plan.residual, plan.task.plant.tip_unit)
    words = f"{plan.energy:.4g} J, {residual}; {structure.scale_words}"
    pale = [part._replace(colour=GHOST) for part in behind.bent if part.colour != FAINT]
    parts = [(*_along(part.points), part.colour, part.width, len(times), words)
             for part in (*pale, *structure.bent)]  # fmt: skip
    corners = np.vstack([structure.corners, behind.corners])
    return {
        "film": parts,
        "corners": _plain([corners.min(axis=0), corners.max(axis=0)]),
        "paths": [*map(_along, structure.paths)],
    }


def _along(points: NDArray[np.float64]) -> tuple[Any, ...]:
    """Abscissas and ordinates of points, one after another."""
    return tuple(_plain(points[..., k].ravel()) for k in (0, 1))


def _plain(values: ArrayLike) -> Any:
    # of what is drawn, behind the point: lists are in the browser sooner than many arrays
    digits = 6
    return np.round(np.asarray(values), digits).tolist()
