"""The plots of the page: the structure in motion, the front, robustness, quantities over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, ScaleBar
from bokeh.plotting import figure
from numpy.typing import NDArray
from quietarm.ocp import Plan, evaluate_robustness
from quietarm.studies.explore.move import Explored
from quietarm.studies.figures.looks import BLUE, ORANGE, RED
from quietarm.studies.figures.motion import Line, curves, heading, scale_of
from quietarm.studies.figures.structure import INK, structures_of
from quietarm.studies.report.words import residual_words

GREY = "#9e9e9e"
PANELS = ("deflection", "angle", "torque", "speed", "acceleration", "jerk")
FRAMES = 25
"""A second."""
FREQUENCY = 0.2
"""Largest error of the frequency that is looked at."""
_POINTS = 200
"""Of a curve: on a panel a third of a screen wide their corners cannot be seen."""
_DIGITS = 6
"""Of what is drawn, behind the point: lists are in the browser sooner than many arrays."""
_IN_SIGHT = 0.4
"""A limit is drawn where the motion comes to this share of it; else it would flatten the motion."""
_HIGHER = 280
_NO_FRONT = "Press Front to see what each millimetre saves"
_PLAY = Path(__file__).with_name("play.js").read_text()
"""The frame of the moment, and the last one for a second."""
_BODY, _CURVE, _POINT = ("xs", "ys", "colour", "width"), ("xs", "ys", "colour", "dash"), ("x", "y")
Array = NDArray[np.float64]
Rows = list[tuple[Any, ...]]
"""Of a source, in the order of its columns."""


class Plots:
    """All plots by name; `pick` is told the number of a point of the front that is clicked."""

    def __init__(self, document: Document, joint: str, pick: Callable[[int], None]) -> None:
        self._sources: dict[str, ColumnDataSource] = {}
        titles = {"robustness": ("residual if the frequency is wrong [mm]", "its error [%]")}
        titles |= {name: (heading(name, joint), "time [s]  (dotted: arrival)") for name in PANELS}
        panels = [self._panel(name, *words) for name, words in titles.items()]
        self.roots = [self._stage(document), self._tradeoff(pick), *panels]

    def show(self, explored: Explored) -> None:
        """Show another motion in all plots."""
        self._sources["points"].selected.indices = []  # so that one can be clicked again
        front = explored.front.points if explored.front else ()
        self._front.title.text = "front (cross: this motion)" if front else _NO_FRONT
        self._front.axis.visible = bool(front)
        here = [explored.plan] if front else []
        rows = _film(explored.plan) | {"robustness": [*_robustness(explored)]}
        for name, motions in (("points", front), ("here", here)):
            rows[name] = [(1e3 * one.residual, one.energy) for one in motions]
        rows |= {name: [*_quantity(explored, name)] for name in PANELS}
        for name, source in self._sources.items():
            columns: Any = [*zip(*rows[name], strict=True)] or [()] * len(source.column_names)
            source.data = dict(zip(source.column_names, map(list, columns), strict=True))

    def _source(self, name: str, columns: Sequence[str]) -> ColumnDataSource:
        self._sources[name] = ColumnDataSource({column: [] for column in columns})
        return self._sources[name]

    def _stage(self, document: Document) -> Any:
        """The structure, which the browser plays by itself."""
        plot: Any = figure(name="stage", title=" ", tools="", height=_HIGHER, match_aspect=True)
        plot.grid.visible = plot.axis.visible = False
        film = self._source("film", (*_BODY, "frames", "words"))
        shown = ColumnDataSource({name: [] for name in _BODY})
        room = plot.scatter(*_POINT, source=self._source("corners", _POINT), alpha=0)
        plot.x_range, plot.y_range = (
            DataRange1d(renderers=[room], range_padding=0.2) for _ in _POINT
        )
        plot.add_layout(ScaleBar(range=plot.x_range, unit="m"))
        plot.multi_line("xs", "ys", source=self._source("paths", ("xs", "ys")), color=GREY)
        plot.multi_line("xs", "ys", source=shown, color="colour", line_width="width",
                        line_cap="round", line_join="round")  # fmt: skip
        shown.syncable = plot.title.syncable = False  # frames are no news for the server
        play = {"film": film, "shown": shown, "title": plot.title, "rate": FRAMES}
        document.js_on_event("document_ready", CustomJS(args=play, code=_PLAY))
        plot.tags = [film]  # else it would be no part of the document
        return plot

    def _tradeoff(self, pick: Callable[[int], None]) -> Any:
        """The front, and where the motion in hand lies."""
        plot: Any = figure(
            name="front", title=_NO_FRONT, tools="tap", x_axis_label="residual F1 [mm]",
            y_axis_label="energy F2 [J]",
        )  # fmt: skip
        self._front = plot
        points, here = self._source("points", _POINT), self._source("here", _POINT)
        points.selected.on_change("indices", lambda _, old, new: pick(new[0]) if new else None)
        plot.line(*_POINT, source=points, color=BLUE)
        plot.scatter(*_POINT, source=points, color=BLUE, size=9, nonselection_alpha=1)
        plot.scatter(*_POINT, source=here, color=RED, marker="x", size=20, line_width=2.5,
                     level="overlay")  # fmt: skip
        return plot

    def _panel(self, name: str, title: str, below: str) -> Any:
        """Curves over one axis."""
        plot: Any = figure(name=name, title=title, tools="", x_axis_label=below)
        plot.multi_line("xs", "ys", source=self._source(name, _CURVE), line_color="colour",
                        line_dash="dash", line_width=1.6)  # fmt: skip
        return plot


def _quantity(explored: Explored, name: str) -> Iterator[tuple[Any, ...]]:
    """A quantity of the plain cycloid, the kept motion and that in hand; limits, arrival."""
    task, kept = explored.task, explored.kept
    every = [(explored.cycloid, GREY), *([(kept, ORANGE)] if kept else []), (explored.plan, BLUE)]
    levels = [0.0]
    for plan, colour in every:
        some = slice(None, None, max(1, len(plan.trajectory.time) // _POINTS))
        for values in curves(plan, name):
            levels += [float(values.min()), float(values.max())]
            dash = "dashed" if plan is kept else "solid"
            yield _plain(plan.trajectory.time[some]), _plain(values[some]), colour, dash
    limit = task.limit_of(name)
    if limit is not None and limit.peak_of(explored.plan.motion) >= _IN_SIGHT * limit.size:
        for side in scale_of(name) * np.array([limit.lower, limit.upper]):
            levels.append(float(side))
            yield [0.0, task.duration], [side, side], RED, "dashed"
    yield [task.duration, task.duration], [min(levels), max(levels)], INK, "dotted"


def _robustness(explored: Explored) -> Iterator[tuple[Any, ...]]:
    """The residual [mm] over the error of the frequency [%], and what is tolerated."""
    plan, ranges = explored.plan, {"frequency": FREQUENCY}
    found = evaluate_robustness(plan.task, plan.profile, plan.coefficients, ranges, samples=1)
    (sweep,), tolerated = found.sweeps, 1e3 * found.tolerated
    errors = _plain(100 * sweep.errors)
    yield errors, _plain(1e3 * sweep.figures.residual), BLUE, "solid"
    yield [errors[0], errors[-1]], [tolerated, tolerated], GREY, "dashed"


def _film(plan: Plan) -> dict[str, Rows]:
    """The structure of a plan from its start to the end of the residual window, all frames."""
    end = plan.task.duration + plan.task.residual_window
    times = np.arange(0.0, end, 1 / FRAMES)
    (one,) = structures_of([Line(plan, "", BLUE)], times, end)
    scale = "to scale" if one.scale == 1 else f"deflection x {one.scale:g}"
    words = f"{plan.energy:.4g} J, {residual_words(plan.residual)}; {scale}"
    parts = [(*_along(part.points), part.colour, part.width, len(times), words)
             for part in one.bent]  # fmt: skip
    return {"film": parts, "corners": _plain(one.corners), "paths": [*map(_along, one.paths)]}


def _along(points: Array) -> tuple[Any, ...]:
    """Abscissas and ordinates of points, one after another."""
    return tuple(_plain(points[..., k].ravel()) for k in (0, 1))


def _plain(values: Array) -> Any:
    return np.round(values, _DIGITS).tolist()
