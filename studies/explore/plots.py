"""The plots of the page, and how all of them come to show another motion at once. Bokeh draws."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bokeh.document import Document
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, ScaleBar
from bokeh.plotting import figure
from quietarm.studies.display.words import residual_words
from quietarm.studies.explore.drawn import (
    FRAMES,
    GREY,
    TITLES,
    Curve,
    film,
    panels,
    robustness_curves,
)
from quietarm.studies.explore.state import Explored
from quietarm.studies.figures.looks import BLUE, RED

_HIGH, _HIGHER = 200, 280
_CURVE = "xs", "ys", "colour", "dash"
_BODY = "xs", "ys", "colour", "width"
_POINT = "residual", "energy"
_TIME = "time [s]  (dotted: arrival)"
_NO_FRONT = "Press Front to see what each millimetre saves"
_HAND_OUT = "JSON.parse(news.data.text[0]).forEach((columns, i) => { sources[i].data = columns; });"
"""One message for all plots, so that the browser draws once; Bokeh looks at every number of a list,
and not into a text."""
_PLAY = Path(__file__).with_name("play.js").read_text()
"""The frame of the moment, and the last one for a second."""


class Plots:
    """The structure in motion, the front, the robustness, and the quantities over time.

    `pick` is told the number of a point of the front that is clicked.
    """

    def __init__(self, document: Document, pick: Callable[[int], None]) -> None:
        self._sources: list[ColumnDataSource] = []
        self.roots = [self._stage(), self._tradeoff(pick)]
        wrong = "residual if the frequency is wrong [mm]"
        self.roots.append(self._panel("robustness", wrong, "error of the frequency [%]"))
        self.roots += [self._panel(name, title, _TIME) for name, title in TITLES.items()]
        self._news = ColumnDataSource({"text": []})
        self.roots[0].tags = [self._news]  # else it would be no part of the document
        hand_out = CustomJS(args={"news": self._news, "sources": self._sources}, code=_HAND_OUT)
        self._news.js_on_change("data", hand_out)
        document.js_on_event("document_ready", hand_out, self._play)

    def show(self, explored: Explored) -> None:
        """Show another motion in all plots."""
        self._points.selected.indices = []  # so that the same point can be clicked again
        empty = explored.front is None
        self._front.title.text = _NO_FRONT if empty else "front (cross: this motion)"
        self._front.axis.visible = not empty
        curves = [robustness_curves(explored), *panels(explored).values()]
        columns = [*_of_stage(explored), *_of_front(explored), *map(_of_curves, curves)]
        self._news.data = {"text": [json.dumps(columns)]}

    def _stage(self) -> Any:
        """The structure, which the browser plays by itself."""
        plot = _plot("stage", " ", height=_HIGHER, match_aspect=True)
        plot.grid.visible = plot.axis.visible = False
        film, paths, corners = self._source(), self._source("xs", "ys"), self._source("x", "y")
        room = plot.scatter("x", "y", source=corners, alpha=0)
        plot.x_range, plot.y_range = (
            DataRange1d(renderers=[room], range_padding=0.2) for _ in "xy"
        )
        plot.add_layout(
            ScaleBar(
                range=plot.x_range, unit="m", location="bottom_right", background_fill_alpha=0,
                border_line_alpha=0,
            )
        )  # fmt: skip
        plot.multi_line("xs", "ys", source=paths, color=GREY, line_width=1.5)
        shown = _empty(*_BODY)
        plot.multi_line(
            "xs", "ys", source=shown, color="colour", line_width="width", line_cap="round",
            line_join="round",
        )  # fmt: skip
        plot.title.syncable = False
        seen = {"film": film, "shown": shown, "title": plot.title, "rate": FRAMES}
        self._play = CustomJS(args=seen, code=_PLAY)
        return plot

    def _tradeoff(self, pick: Callable[[int], None]) -> Any:
        """The front, and where the motion in hand lies."""
        self._front = plot = _plot("front", _NO_FRONT, tools="tap")
        plot.xaxis.axis_label, plot.yaxis.axis_label = "residual F1 [mm]", "energy F2 [J]"
        self._points, here = self._source(*_POINT), self._source(*_POINT)

        def picked(attribute: str, old: Sequence[int], new: Sequence[int]) -> None:
            if new:
                pick(new[0])

        self._points.selected.on_change("indices", picked)
        plot.line(*_POINT, source=self._points, color=BLUE)
        plot.scatter(*_POINT, source=self._points, color=BLUE, size=9, nonselection_alpha=1)
        above = {"size": 20, "line_width": 2.5, "level": "overlay"}
        plot.scatter(*_POINT, source=here, color=RED, marker="x", **above)
        return plot

    def _panel(self, name: str, title: str, below: str) -> Any:
        """Curves over one axis."""
        plot = _plot(name, title)
        plot.xaxis.axis_label = below
        look = {"line_color": "colour", "line_dash": "dash", "line_width": 1.6}
        plot.multi_line("xs", "ys", source=self._source(*_CURVE), **look)
        return plot

    def _source(self, *columns: str) -> ColumnDataSource:
        self._sources.append(_empty(*columns))
        return self._sources[-1]


def _empty(*columns: str) -> ColumnDataSource:
    """A source that is filled in the browser, which is no news for the server."""
    return ColumnDataSource({name: [] for name in columns}, syncable=False)


def _of_stage(explored: Explored) -> list[Mapping[str, Any]]:
    seen, plan = film(explored.plan), explored.plan
    scale = "to scale" if seen.scale == 1 else f"deflection x {seen.scale:g}"
    words = f"{plan.energy:.4g} J, {residual_words(plan.residual)}; {scale}"
    alike = {"frames": [seen.frames] * len(seen.xs), "words": [words] * len(seen.xs)}
    return [
        {"xs": seen.xs, "ys": seen.ys, **seen.looks, **alike},
        dict(zip(("xs", "ys"), seen.paths, strict=True)),
        dict(zip("xy", seen.corners, strict=True)),
    ]


def _of_front(explored: Explored) -> list[Mapping[str, Any]]:
    front = explored.front
    points_and_here = ([], []) if front is None else (front.points, [explored.plan])
    return [
        {"residual": [1e3 * one.residual for one in of], "energy": [one.energy for one in of]}
        for of in points_and_here
    ]


def _of_curves(curves: Sequence[Curve]) -> Mapping[str, Any]:
    return {name: [curve[i] for curve in curves] for i, name in enumerate(_CURVE)}


def _plot(name: str, title: str, height: int = _HIGH, tools: str = "", **more: Any) -> Any:
    plot: Any = figure(
        name=name, title=title, height=height, tools=tools, toolbar_location=None,
        sizing_mode="stretch_width", **more,
    )  # fmt: skip
    plot.title.text_font_size = "12px"
    return plot
