"""The page: widgets that change the move in hand, and pictures of it. Bokeh draws and listens."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from html import escape
from typing import Any, TypeVar

from bokeh.document import Document
from bokeh.layouts import column, row
from bokeh.models import (
    Button,
    ColumnDataSource,
    CustomJS,
    DataRange1d,
    Div,
    Select,
    Slider,
    Spinner,
    UIElement,
)
from bokeh.plotting import figure
from jinja2 import Environment, PackageLoader
from quietarm.models import Plant
from quietarm.ocp import Front, Plan, QuietarmError
from quietarm.studies.display.words import plant_words
from quietarm.studies.document.blocks import Facts
from quietarm.studies.explore.drawn import (
    FRAMES,
    GREY,
    TITLES,
    Curve,
    film,
    panels,
    robustness_curves,
)
from quietarm.studies.explore.state import FILES, Dial, Explored
from quietarm.studies.figures.looks import BLUE, RED
from quietarm.studies.reports.plan import plan_document

T = TypeVar("T")
_WAIT = 10
"""Milliseconds in which changes are gathered: a slider that is dragged sends more than are drawn."""
_WORK = ThreadPoolExecutor(1, "explore")
"""Where answers are computed, while the page goes on."""
_PLAY = """
const play = () => {
    const end = Object.keys(frames.data).length ? frames.get_length() : 0;
    if (end) {
        const bodies = shown.data.xs.length;
        const now = Math.floor(performance.now() / 1000 * rate) % (end + rate);
        const at = Math.min(now, end - 1), xs = [], ys = [];
        const of = (name) => {
            const all = frames.data[name], points = all.shape[1];
            return Array.from(all.subarray(at * points, (at + 1) * points));
        };
        for (let i = 0; i < bodies; i++) { xs.push(of("x" + i)); ys.push(of("y" + i)); }
        shown.data = {...shown.data, xs, ys};
        plot.title.text = words.text + ", t = " + (at / rate).toFixed(2) + " s";
    }
};
setInterval(play, 1000 / rate);
"""
_SAVE = """
const link = document.createElement("a");
link.href = URL.createObjectURL(new Blob([file.data.text[0]], {type: "text/plain"}));
link.download = file.data.name[0];
link.click();
URL.revokeObjectURL(link.href);
"""


class Page:
    """One visitor's page.

    Parameters
    ----------
    document : Document
        What the browser shows; it is filled here.
    explored : Explored
        The move in hand.
    plants : mapping of str to Plant
        Plants that can be chosen, by what the menu calls them.
    """

    def __init__(
        self, document: Document, explored: Explored, plants: Mapping[str, Plant]
    ) -> None:
        self._document, self._explored, self._plants = document, explored, plants
        self._pending: dict[str, float | None] = {}
        self._filling = False
        self._widgets: dict[str, list[Slider | Spinner]] = {}
        self._said = Div(name="said")
        self._figures = Div(name="figures", sizing_mode="stretch_width")
        self._file = ColumnDataSource({"name": [], "text": []})
        self._file.js_on_change("data", CustomJS(args={"file": self._file}, code=_SAVE))
        self._plant = Select(
            title="plant", options=list(plants), sizing_mode="stretch_width",
            disabled=explored.library is not None,
        )  # fmt: skip
        self._plant.on_change("value", self._on_plant)
        self._solve = Button(label="Plan", button_type="primary", sizing_mode="stretch_width")
        self._solve.on_click(self._on_plan)
        self._trade = Button(label="Front", sizing_mode="stretch_width")
        self._trade.on_click(self._on_front)
        self._shape = column(name="shape", sizing_mode="stretch_width")
        self._curves = {name: _panel(name, title) for name, title in TITLES.items()}
        self._robustness = _panel("robustness", "residual [mm] over error of the frequency [%]")
        self._build()
        self._show()

    def _build(self) -> None:
        """Put everything on the page."""
        limits = [name for name, dial in self._explored.dials.items() if dial.optional]
        moves = [
            name
            for name in self._explored.dials
            if name not in limits and name not in self._explored.coefficients
        ]
        downloads = [Button(label=name, width=110) for name in FILES]
        for button in downloads:
            button.on_click(partial(self._on_file, button.label))
        self._front_plot()
        self._stage_plot()
        roots: list[UIElement] = [
            self._said, self._figures, self._stage, self._front, self._robustness[0], self._shape,
            column(self._plant, row(self._solve, self._trade, sizing_mode="stretch_width"),
                   name="answers", sizing_mode="stretch_width"),
            column(*map(self._pair, moves), name="move", sizing_mode="stretch_width"),
            column(*map(self._limit, limits), name="limits", sizing_mode="stretch_width"),
            column(row(*downloads[:2]), row(*downloads[2:]), name="files"),
            *(plot for plot, _ in self._curves.values()),
        ]  # fmt: skip
        for root in roots:
            self._document.add_root(root)
        templates = Environment(loader=PackageLoader(__package__, ""), autoescape=False)
        self._document.template = templates.get_template("page.html")
        self._document.template_variables["panels"] = list(TITLES)
        self._document.title = "quietarm explore"

    # What is set by hand.

    def _pair(self, name: str) -> UIElement:
        """A slider, and a field for the same number."""
        dial = self._explored.dials[name]
        ends = {"low": dial.least, "high": dial.most}
        step = _step(dial)
        slider = Slider(
            title=dial.label, start=dial.least, end=dial.most, step=step, value=dial.least,
            show_value=False, sizing_mode="stretch_width",
        )  # fmt: skip
        field = Spinner(**ends, step=step, value=dial.least, width=95, mode="float")
        return row(self._heard(name, slider), self._heard(name, field), sizing_mode="stretch_width")

    def _limit(self, name: str) -> UIElement:
        """A field that may be empty."""
        dial = self._explored.dials[name]
        field = Spinner(
            title=dial.label, low=dial.least, high=dial.most, step=_step(dial), mode="float",
            placeholder="none", sizing_mode="stretch_width",
        )  # fmt: skip
        return self._heard(name, field)

    def _heard(self, name: str, widget: Any) -> Any:
        self._widgets.setdefault(name, []).append(widget)
        widget.name = f"{name} {type(widget).__name__.lower()}"
        widget.on_change("value", lambda attribute, old, new: self._on_dial(name, new))
        return widget

    def _on_dial(self, name: str, value: float | None) -> None:
        if self._filling:
            return
        if not self._pending:
            self._document.add_timeout_callback(self._set, _WAIT)
        self._pending[name] = value

    def _set(self) -> None:
        pending, self._pending = self._pending, {}
        with self._answering():
            self._explored = self._explored.changed(pending)

    def _on_plant(self, attribute: str, old: str, new: str) -> None:
        if not self._filling:
            with self._answering():
                self._explored = self._explored.of_plant(self._plants[new])

    def _on_pick(self, attribute: str, old: Sequence[int], new: Sequence[int]) -> None:
        if new and self._explored.front is not None:
            with self._answering():
                self._explored = self._explored.picked(new[0])

    def _on_file(self, name: str) -> None:
        with self._answering():
            self._file.data = {"name": [name], "text": [self._explored.file(name)]}

    @contextmanager
    def _answering(self) -> Iterator[None]:
        """Show what the block made of the move in hand, or why it could not."""
        try:
            yield
            self._say("")
        except (ValueError, QuietarmError) as error:
            self._say(str(error), RED)
        self._show()

    # What is computed meanwhile.

    def _on_plan(self) -> None:
        self._start(self._explored.solved, self._with_plan, "solving")

    def _with_plan(self, plan: Plan) -> None:
        self._explored = self._explored.with_plan(plan)

    def _on_front(self) -> None:
        def report(done: int, total: int) -> None:
            words = f"front: {done} of {total} points"
            self._document.add_next_tick_callback(lambda: self._say(words))

        self._start(partial(self._explored.found_front, report), self._with_front, "front")

    def _with_front(self, front: Front) -> None:
        self._explored = self._explored.with_front(front)

    def _start(self, work: Callable[[], T], then: Callable[[T], None], words: str) -> None:
        """Compute something beside the page, on which nothing can be set until it is there."""

        def done(future: Future[T]) -> None:
            self._document.add_next_tick_callback(partial(ended, future))

        def ended(future: Future[T]) -> None:
            self._rest(False)
            with self._answering():
                then(future.result())

        self._say(f"{words} ...")
        self._rest(True)
        _WORK.submit(work).add_done_callback(done)

    def _rest(self, at_work: bool) -> None:
        for widget in (self._solve, self._trade, *sum(self._widgets.values(), [])):
            widget.disabled = at_work
        self._plant.disabled = at_work or self._explored.library is not None

    # What is shown.

    def _say(self, words: str, colour: str = GREY) -> None:
        self._said.text = f'<span style="color: {colour}">{escape(words)}</span>'

    def _show(self) -> None:
        """Bring everything on the page to the move in hand."""
        explored = self._explored
        self._fill()
        facts = next(one for one in plan_document(explored.plan).blocks if isinstance(one, Facts))
        self._figures.text = "".join(
            f"<div><b>{escape(name)}</b> {escape(value)}</div>" for name, value in facts.rows
        )
        for name, curves in panels(explored).items():
            self._curves[name][1].data = _lines(curves)
        self._robustness[1].data = _lines(robustness_curves(explored))
        self._show_stage(explored)
        self._show_front(explored)

    def _fill(self) -> None:
        """Show in every field what is held."""
        self._filling = True
        dials, shown = self._explored.dials, self._explored.shown
        if len(self._shape.children) != len(self._explored.coefficients):
            self._shape.children = [self._pair(name) for name in self._explored.coefficients]
        for name, widgets in self._widgets.items():
            for widget in widgets:
                if isinstance(widget, Slider):
                    widget.update(start=dials[name].least, end=dials[name].most)
                else:
                    widget.update(low=dials[name].least, high=dials[name].most)
                if widget.value != shown[name]:
                    widget.value = shown[name]
        words = plant_words(self._explored.task.plant)
        if self._plant.value != words:
            self._plant.value = words
        self._filling = False

    def _stage_plot(self) -> None:
        self._frames, self._words = ColumnDataSource(), Div()
        self._bodies = ColumnDataSource({"xs": [], "ys": [], "colour": [], "width": []})
        self._paths = ColumnDataSource({"xs": [], "ys": []})
        self._corners = ColumnDataSource({"x": [], "y": []})
        self._stage = _plot("stage", " ", height=280, match_aspect=True)
        room = self._stage.scatter("x", "y", source=self._corners, alpha=0)
        self._stage.x_range, self._stage.y_range = (DataRange1d(renderers=[room]) for _ in "xy")
        self._stage.grid.visible = False
        self._stage.multi_line("xs", "ys", source=self._paths, color=GREY, line_width=1.5)
        self._stage.multi_line(
            "xs", "ys", source=self._bodies, color="colour", line_width="width", line_cap="round",
            line_join="round",
        )  # fmt: skip
        given = {
            "frames": self._frames, "shown": self._bodies, "plot": self._stage,
            "words": self._words, "rate": FRAMES,
        }  # fmt: skip
        self._document.js_on_event("document_ready", CustomJS(args=given, code=_PLAY))

    def _show_stage(self, explored: Explored) -> None:
        seen = film(explored.plan)
        first = [[values[0] for key, values in seen.frames.items() if key[0] == k] for k in "xy"]
        self._bodies.data = dict(zip(("xs", "ys"), first, strict=True)) | seen.looks
        self._frames.data = seen.frames
        self._paths.data = {"xs": [p[:, 0] for p in seen.paths], "ys": [p[:, 1] for p in seen.paths]}
        self._corners.data = dict(zip("xy", seen.corners.T, strict=True))
        self._words.text = "to scale" if seen.scale == 1 else f"deflection x {seen.scale:g}"

    def _front_plot(self) -> None:
        self._points = ColumnDataSource({"residual": [], "energy": []})
        self._here = ColumnDataSource({"residual": [], "energy": []})
        self._points.selected.on_change("indices", self._on_pick)
        title = "front: energy [J] over residual [mm]; click a point to see its motion"
        self._front = _plot("front", title, tools="tap")
        at: dict[str, Any] = {"x": "residual", "y": "energy"}
        self._front.line(**at, source=self._points, color=BLUE)
        self._front.scatter(
            **at, source=self._points, color=BLUE, size=10, nonselection_alpha=0.6,
        )  # fmt: skip
        self._front.scatter(**at, source=self._here, color=RED, marker="x", size=12, line_width=2)

    def _show_front(self, explored: Explored) -> None:
        front, plan = explored.front, explored.plan
        if front is None:
            self._points.data = {"residual": [], "energy": []}
        elif len(front.points) != len(self._points.data["residual"]):
            self._points.data = {"residual": 1e3 * front.residuals, "energy": front.energies}
        self._here.data = {"residual": [1e3 * plan.residual], "energy": [plan.energy]}


def _plot(name: str, title: str, height: int = 200, tools: str = "", **more: Any) -> Any:
    plot = figure(
        name=name, title=title, height=height, tools=tools, toolbar_location=None,
        sizing_mode="stretch_width", **more,
    )  # fmt: skip
    plot.title.text_font_size = "12px"
    return plot


def _panel(name: str, title: str) -> tuple[Any, ColumnDataSource]:
    """A plot of curves, and where they come from."""
    source, plot = ColumnDataSource(_lines([])), _plot(name, title)
    plot.multi_line(
        "xs", "ys", source=source, line_color="colour", line_dash="dash", line_width=1.6
    )
    return plot, source


def _lines(curves: Sequence[Curve]) -> dict[str, list[Any]]:
    names = "xs", "ys", "colour", "dash"
    return {name: [curve[i] for curve in curves] for i, name in enumerate(names)}


def _step(dial: Dial) -> float:
    """A step of a slider: a thousandth of its range or less, a power of ten."""
    span = dial.most - dial.least
    return 1.0 if span > 500 else 0.01 if span > 2 else 0.001
