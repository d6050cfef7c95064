"""The plots of the page: the structure in motion, the front, robustness, quantities over time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, ScaleBar
from bokeh.plotting import figure
from numpy.typing import NDArray
from quietarm.ocp import Plan
from quietarm.ocp.limits import QUANTITIES
from quietarm.studies.explore.move import Explored
from quietarm.studies.figures.looks import BLUE, ORANGE, RED
from quietarm.studies.figures.motion import Line, curves, heading
from quietarm.studies.figures.structure import INK, structures_of
from quietarm.studies.report.words import residual_words

GREY = "#9e9e9e"
PANELS = ("deflection", "angle", "torque", "speed", "acceleration", "jerk")
FRAMES = 25
"""A second."""
_POINTS = 200
"""Of a curve: on a panel a third of a screen wide their corners cannot be seen."""
_IN_SIGHT = 0.4
"""A limit is drawn where the motion comes to this share of it; else it would flatten the motion."""
_HIGH, _HIGHER = 200, 280
_NO_FRONT = "Press Front to see what each millimetre saves"
_PLAY = Path(__file__).with_name("play.js").read_text()
"""The frame of the moment, and the last one for a second."""
Columns = dict[str, Any]


class Plots:
    """All plots by name; `pick` is told the number of a point of the front that is clicked."""

    def __init__(self, document: Document, pick: Callable[[int], None]) -> None:
        self._sources: dict[str, ColumnDataSource] = {}
        error = "error of the frequency [%]"
        wrong = self._panel("robustness", "residual if the frequency is wrong [mm]", error)
        time = "time [s]  (dotted: arrival)"
        panels = [self._panel(name, heading(name), time) for name in PANELS]
        self.roots = [self._stage(document), self._tradeoff(pick), wrong, *panels]

    def show(self, explored: Explored) -> None:
        """Show another motion in all plots."""
        self._sources["points"].selected.indices = []  # so that one can be clicked again
        empty = explored.front is None
        self._front.title.text = _NO_FRONT if empty else "front (cross: this motion)"
        self._front.axis.visible = not empty
        columns = _film(explored.plan) | _front(explored)
        columns["robustness"] = _columns(_robustness(explored))
        columns |= {name: _columns(_quantity(explored, name)) for name in PANELS}
        for name, source in self._sources.items():
            source.data = columns[name]

    def _source(self, name: str, *columns: str) -> ColumnDataSource:
        self._sources[name] = ColumnDataSource({column: [] for column in columns})
        return self._sources[name]

    def _stage(self, document: Document) -> Any:
        """The structure, which the browser plays by itself."""
        plot = _plot("stage", " ", height=_HIGHER, match_aspect=True)
        plot.grid.visible = plot.axis.visible = False
        body = "xs", "ys", "colour", "width"
        film, shown = self._source("film", *body), ColumnDataSource({name: [] for name in body})
        room = plot.scatter("x", "y", source=self._source("corners", "x", "y"), alpha=0)
        plot.x_range, plot.y_range = (
            DataRange1d(renderers=[room], range_padding=0.2) for _ in "xy"
        )
        plot.add_layout(ScaleBar(
            range=plot.x_range, unit="m", location="bottom_right", background_fill_alpha=0,
            border_line_alpha=0,
        ))  # fmt: skip
        plot.multi_line("xs", "ys", source=self._source("paths", "xs", "ys"), color=GREY)
        plot.multi_line("xs", "ys", source=shown, color="colour", line_width="width",
                        line_cap="round", line_join="round")  # fmt: skip
        shown.syncable = plot.title.syncable = False  # frames are no news for the server
        play = {"film": film, "shown": shown, "title": plot.title, "rate": FRAMES}
        document.js_on_event("document_ready", CustomJS(args=play, code=_PLAY))
        plot.tags = [film]  # else it would be no part of the document
        return plot

    def _tradeoff(self, pick: Callable[[int], None]) -> Any:
        """The front, and where the motion in hand lies."""
        self._front = plot = _plot("front", _NO_FRONT, tools="tap")
        plot.xaxis.axis_label, plot.yaxis.axis_label = "residual F1 [mm]", "energy F2 [J]"
        point = "residual", "energy"
        points, here = self._source("points", *point), self._source("here", *point)

        def picked(attribute: str, old: Sequence[int], new: Sequence[int]) -> None:
            if new:
                pick(new[0])

        points.selected.on_change("indices", picked)
        plot.line(*point, source=points, color=BLUE)
        plot.scatter(*point, source=points, color=BLUE, size=9, nonselection_alpha=1)
        above = {"size": 20, "line_width": 2.5, "level": "overlay"}
        plot.scatter(*point, source=here, color=RED, marker="x", **above)
        return plot

    def _panel(self, name: str, title: str, below: str) -> Any:
        """Curves over one axis."""
        plot = _plot(name, title)
        plot.xaxis.axis_label = below
        source = self._source(name, "xs", "ys", "colour", "dash")
        plot.multi_line("xs", "ys", source=source, line_color="colour", line_dash="dash",
                        line_width=1.6)  # fmt: skip
        return plot


def _plot(name: str, title: str, height: int = _HIGH, tools: str = "", **more: Any) -> Any:
    plot: Any = figure(
        name=name, title=title, height=height, tools=tools, toolbar_location=None,
        sizing_mode="stretch_width", **more,
    )  # fmt: skip
    plot.title.text_font_size = "12px"
    return plot


Curve = tuple[NDArray[np.float64], NDArray[np.float64], str, str]
"""Abscissas, ordinates, colour and dash."""


def _quantity(explored: Explored, name: str) -> Iterator[Curve]:
    """A quantity of the plain cycloid, the kept motion and that in hand; limits, arrival."""
    task, kept = explored.task, explored.kept
    every = [(explored.cycloid, GREY), *([(kept, ORANGE)] if kept else []), (explored.plan, BLUE)]
    low = high = 0.0
    for plan, colour in every:
        some = slice(None, None, max(1, len(plan.trajectory.time) // _POINTS))
        for values in curves(plan, name):
            low, high = min(low, values.min()), max(high, values.max())
            dash = "dashed" if plan is kept else "solid"
            yield plan.trajectory.time[some], values[some], colour, dash
    limit = task.limit_of(name)
    if limit is not None and limit.peak_of(explored.plan.motion) >= _IN_SIGHT * limit.size:
        factor = 1e3 if QUANTITIES[name].unit == "m" else 1.0
        sides = factor * limit.upper, factor * limit.lower
        low, high = min(low, *sides), max(high, *sides)
        for side in sides:
            yield np.array([0.0, task.duration]), np.full(2, side), RED, "dashed"
    yield np.full(2, task.duration), np.array([low, high]), INK, "dotted"


def _robustness(explored: Explored) -> Iterator[Curve]:
    """The residual [mm] over the error of the frequency [%], and what is tolerated."""
    (sweep,) = explored.robustness.sweeps
    errors = 100 * sweep.errors
    yield errors, 1e3 * sweep.figures.residual, BLUE, "solid"
    yield errors[[0, -1]], np.full(2, 1e3 * explored.robustness.tolerated), GREY, "dashed"


def _columns(every: Iterator[Curve]) -> Columns:
    xs, ys, colours, dashes = zip(*every, strict=True)
    lists = {"xs": [*map(_plain, xs)], "ys": [*map(_plain, ys)]}
    return lists | {"colour": [*colours], "dash": [*dashes]}


def _front(explored: Explored) -> dict[str, Columns]:
    front = explored.front
    shown = {"points": front.points if front else (), "here": [explored.plan] if front else ()}
    return {
        name: {"residual": [1e3 * one.residual for one in points],
               "energy": [one.energy for one in points]}
        for name, points in shown.items()
    }  # fmt: skip


def _film(plan: Plan) -> dict[str, Columns]:
    """The structure of a plan from its start to the end of the residual window, all frames."""
    end = plan.task.duration + plan.task.residual_window
    times = np.arange(0.0, end, 1 / FRAMES)
    (one,) = structures_of([Line(plan, "", BLUE)], times, end)
    xs, ys = ([_plain(part.points[..., k].ravel()) for part in one.bent] for k in (0, 1))
    looks = {"colour": [part.colour for part in one.bent], "width": [p.width for p in one.bent]}
    scale = "to scale" if one.scale == 1 else f"deflection x {one.scale:g}"
    words = f"{plan.energy:.4g} J, {residual_words(plan.residual)}; {scale}"
    alike = {"frames": [len(times)] * len(xs), "words": [words] * len(xs)}
    paths = {
        key: [_plain(path[:, axis]) for path in one.paths] for axis, key in enumerate(("xs", "ys"))
    }
    return {
        "film": {"xs": xs, "ys": ys, **looks, **alike},
        "corners": dict(zip("xy", map(_plain, one.corners.T), strict=True)),
        "paths": paths,
    }


def _plain(values: NDArray[np.float64]) -> list[float]:
    """Numbers to five digits of the largest: lists are in the browser sooner than many arrays."""
    largest = float(np.abs(values).max(initial=0.0))
    digits = 0 if largest == 0 else 4 - math.floor(math.log10(largest))
    return np.round(values, digits).tolist()
