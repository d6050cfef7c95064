"""The plots of the page, each with how it comes to show another motion. Bokeh draws them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from bokeh.document import Document
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d
from bokeh.plotting import figure
from quietarm.ocp import Front
from quietarm.studies.display.words import residual_words
from quietarm.studies.explore.drawn import FRAMES, GREY, Curve, film
from quietarm.studies.explore.state import Explored
from quietarm.studies.figures.looks import BLUE, RED

_HIGH, _HIGHER = 200, 280
_PLAY = """
const play = () => {
    const {xs, ys, colour, width, frames, words} = film.data;
    const now = Math.floor(performance.now() / 1000 * rate) % (frames[0] + rate);
    const at = Math.min(now, frames[0] - 1);
    const current = (all) => {
        const points = all.length / frames[0];
        return Array.from({length: points}, (_, k) => all[at * points + k]);
    };
    shown.data = {xs: xs.map(current), ys: ys.map(current), colour, width};
    title.text = `${words[0]}, t = ${(at / rate).toFixed(2)} s`;
};
setInterval(play, 1000 / rate);
"""
"""The frame of the moment, and the last one for a second."""


class Panel:
    """Curves over one axis."""

    def __init__(self, name: str, title: str, below: str) -> None:
        self.plot = _plot(name, title)
        self.plot.xaxis.axis_label = below
        self._source = ColumnDataSource(_columns([]))
        self.plot.multi_line(
            "xs", "ys", source=self._source, line_color="colour", line_dash="dash", line_width=1.6
        )

    def show(self, curves: Sequence[Curve]) -> None:
        """Show other curves."""
        self._source.data = _columns(curves)


def _columns(curves: Sequence[Curve]) -> dict[str, list[Any]]:
    names = "xs", "ys", "colour", "dash"
    return {name: [curve[i] for curve in curves] for i, name in enumerate(names)}


class Stage:
    """The structure in motion, which the browser plays by itself."""

    def __init__(self, document: Document) -> None:
        self.plot = _plot("stage", " ", height=_HIGHER, match_aspect=True)
        self.plot.grid.visible = False
        self._film = ColumnDataSource()
        self.plot.tags = [self._film]  # else it would be no part of the document
        self._paths = ColumnDataSource({"xs": [], "ys": []})
        self._corners = ColumnDataSource({"x": [], "y": []})
        room = self.plot.scatter("x", "y", source=self._corners, alpha=0)
        self.plot.x_range, self.plot.y_range = (DataRange1d(renderers=[room]) for _ in "xy")
        self.plot.multi_line("xs", "ys", source=self._paths, color=GREY, line_width=1.5)
        # what plays is no news for the server
        shown = ColumnDataSource({"xs": [], "ys": [], "colour": [], "width": []}, syncable=False)
        self.plot.title.syncable = False
        self.plot.multi_line(
            "xs", "ys", source=shown, color="colour", line_width="width", line_cap="round",
            line_join="round",
        )  # fmt: skip
        seen = {"film": self._film, "shown": shown, "title": self.plot.title, "rate": FRAMES}
        document.js_on_event("document_ready", CustomJS(args=seen, code=_PLAY))

    def show(self, explored: Explored) -> None:
        """Show another motion."""
        seen = film(explored.plan)
        scale = "to scale" if seen.scale == 1 else f"deflection x {seen.scale:g}"
        plan = explored.plan
        words = f"{plan.energy:.4g} J, {residual_words(plan.residual)}; {scale}"
        alike = {"frames": [seen.frames] * len(seen.xs), "words": [words] * len(seen.xs)}
        self._film.data = {"xs": seen.xs, "ys": seen.ys, **seen.looks, **alike}
        xs, ys = ([path[:, axis] for path in seen.paths] for axis in (0, 1))
        self._paths.data = {"xs": xs, "ys": ys}
        self._corners.data = {"x": seen.corners[:, 0], "y": seen.corners[:, 1]}


class Tradeoff:
    """The front, and where the motion in hand lies."""

    def __init__(self, pick: Callable[[int], None]) -> None:
        self.plot = _plot("front", "front: energy [J] over residual [mm]", tools="tap")
        self._points, self._here = (
            ColumnDataSource({"residual": [], "energy": []}) for _ in range(2)
        )
        self._drawn: Front | None = None

        def picked(attribute: str, old: Sequence[int], new: Sequence[int]) -> None:
            if new:
                pick(new[0])

        self._points.selected.on_change("indices", picked)
        at = {"x": "residual", "y": "energy"}
        self.plot.line(**at, source=self._points, color=BLUE)
        self.plot.scatter(**at, source=self._points, color=BLUE, size=9, nonselection_alpha=1)
        self.plot.scatter(**at, source=self._here, color=RED, marker="x", size=12, line_width=2)

    def show(self, explored: Explored) -> None:
        """Show another front, or where another motion lies."""
        front, plan = explored.front, explored.plan
        if front is not self._drawn:
            self._drawn = front
            columns = ([], []) if front is None else (1e3 * front.residuals, front.energies)
            self._points.data = dict(zip(("residual", "energy"), columns, strict=True))
        self._points.selected.indices = []  # so that the same point can be clicked again
        self._here.data = {"residual": [1e3 * plan.residual], "energy": [plan.energy]}


def _plot(name: str, title: str, height: int = _HIGH, tools: str = "", **more: Any) -> Any:
    plot = figure(
        name=name, title=title, height=height, tools=tools, toolbar_location=None,
        sizing_mode="stretch_width", **more,
    )  # fmt: skip
    plot.title.text_font_size = "12px"
    return plot
