"""The page: fields and sliders that change the motion in hand, and what is shown of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from html import escape
from itertools import chain
from pathlib import Path
from typing import Any

from bokeh.document import Document
from bokeh.layouts import column, row
from bokeh.models import Button, ColumnDataSource, CustomJS, Div, Select, Slider, Spinner, UIElement
from jinja2 import Environment, PackageLoader
from quietarm.models import Plant
from quietarm.ocp import QuietarmError
from quietarm.studies.display.words import moved
from quietarm.studies.document.blocks import Facts
from quietarm.studies.explore.drawn import GREY, TITLES
from quietarm.studies.explore.plots import Plots
from quietarm.studies.explore.state import FILES, Dial, Explored
from quietarm.studies.figures.looks import RED
from quietarm.studies.reports.plan import HARD_REMEDY, plan_document

_WAIT = 5
"""Milliseconds in which changes are gathered: a slider sends more of them than are drawn."""
_WORK = ThreadPoolExecutor(1, "explore")
"""Where plans and fronts are computed, while the page goes on."""
_DIGITS = "0[.][0000]"
"""Of a field."""
_WIDE: Mapping[str, Any] = {"sizing_mode": "stretch_width"}
_SAVE = Path(__file__).with_name("save.js").read_text()


class Page:
    """One visitor's page: the motion in hand, and plants that can be chosen by their words."""

    def __init__(self, document: Document, explored: Explored, plants: Mapping[str, Plant]) -> None:
        self._document, self._explored, self._plants = document, explored, plants
        self._pending: dict[str, float | None] = {}
        self._filling = False
        self._fields: dict[str, list[Any]] = {name: [] for name in explored.dials}
        self._figures = Div(name="figures", **_WIDE)
        self._plots = Plots(document, self._on_pick)
        self._saved, self._file = 0, ColumnDataSource({"name": [], "text": [], "number": []})
        self._file.js_on_change("data", CustomJS(args={"file": self._file}, code=_SAVE))
        # as a tag it is part of the document
        self._said = Div(name="said", tags=[self._file], **_WIDE)
        self._plant = Select(title="plant", options=list(plants), **_WIDE)
        self._plant.on_change("value", self._on_plant)
        self._buttons = [
            _button("Plan", self._on_plan, button_type="primary"),
            _button("Front", self._on_front),
            _button("Plain cycloid", self._on_plain),
        ]
        for root in self._roots():
            document.add_root(root)
        document.title = "quietarm explore"
        loader = PackageLoader("quietarm.studies", "explore")
        document.template = Environment(loader=loader, autoescape=True).get_template("page.html")
        document.template_variables["panels"] = list(TITLES)
        self._disable(False)
        self._show()

    def _roots(self) -> list[UIElement]:
        """What the template puts into its places, by name."""
        explored = self._explored
        limits = [self._limit(name, dial) for name, dial in explored.dials.items() if dial.optional]
        sliders = {
            name: self._slider(name, dial)
            for name, dial in explored.dials.items()
            if not dial.optional
        }
        shape = [sliders.pop(name) for name in explored.coefficients]
        files = [_button(name, partial(self._on_file, name)) for name in FILES]
        return [
            self._said, self._figures, *self._plots.roots,
            column(self._plant, row(*self._buttons, **_WIDE), name="answers", **_WIDE),
            column(*sliders.values(), name="move", **_WIDE),
            column(*shape, name="shape", **_WIDE),
            column(*_in_twos(limits), name="limits", **_WIDE),
            column(*_in_twos(files), name="files", **_WIDE),
        ]  # fmt: skip

    def _slider(self, name: str, dial: Dial) -> UIElement:
        """A field, and a slider for the same number."""
        field = Spinner(title=dial.label, step=_step(dial), format=_DIGITS, width=95)
        slider = Slider(
            start=dial.least, end=dial.most, value=dial.least, step=_step(dial), show_value=False,
            align="end", **_WIDE,
        )  # fmt: skip
        return row(self._heard(name, field), self._heard(name, slider), **_WIDE)

    def _limit(self, name: str, dial: Dial) -> UIElement:
        """A field that may be empty."""
        field = Spinner(title=dial.label, format=_DIGITS, placeholder="none", **_WIDE)
        return self._heard(name, field)

    def _heard(self, name: str, field: Any) -> Any:
        self._fields[name].append(field)
        field.name = f"{name}-{type(field).__name__.lower()}"
        field.on_change("value", lambda attribute, old, new: self._on_field(name, new))
        return field

    def _on_field(self, name: str, value: float | None) -> None:
        if self._filling:
            return
        if not self._pending:
            self._document.add_timeout_callback(self._on_time, _WAIT)
        self._pending[name] = value

    def _on_time(self) -> None:
        self._set()

    def _set(self) -> bool:
        """Set what was gathered; False where that cannot be."""
        pending, self._pending = self._pending, {}
        return not pending or self._answer(lambda: self._explored.changed(pending))

    def _on_plant(self, attribute: str, old: str, new: str) -> None:
        if not self._filling:
            self._answer(lambda: self._explored.of_plant(self._plants[new]))

    def _on_pick(self, number: int) -> None:
        self._answer(lambda: self._explored.picked(number))

    def _on_file(self, name: str) -> None:
        if self._set():
            self._saved += 1  # so that the same file can be saved again
            text = self._explored.file(name)
            self._file.data = {"name": [name], "text": [text], "number": [self._saved]}

    def _on_plain(self) -> None:
        if self._set():
            self._answer(self._explored.plain)

    def _on_plan(self) -> None:
        if self._set():
            self._begin(self._explored.solved, "solving ...")

    def _on_front(self) -> None:
        def report(done: int, total: int) -> None:
            words = f"front: {done} of {total} points"
            self._document.add_next_tick_callback(lambda: self._say(words))

        if self._set():
            work = partial(self._explored.with_front, report)
            self._begin(work, "front ...", "click a point of the front to see its motion")

    def _begin(self, work: Callable[[], Explored], words: str, then: str = "") -> None:
        """Compute something beside the page, on which nothing can be set until it is there."""

        def done(future: Future[Explored]) -> None:
            self._document.add_next_tick_callback(lambda: ended(future))

        def ended(future: Future[Explored]) -> None:
            self._disable(False)
            self._answer(future.result, then)

        self._say(words)
        self._disable(True)
        _WORK.submit(work).add_done_callback(done)

    def _disable(self, at_work: bool) -> None:
        for field in (*self._buttons, *chain(*self._fields.values())):
            field.disabled = at_work
        self._plant.disabled = at_work or self._explored.library is not None

    def _answer(self, change: Callable[[], Explored], then: str = "") -> bool:
        """Take and show another motion in hand; False where there is none, and it is said why."""
        before = self._explored
        try:
            self._explored = change()
            self._say(then)
        except (ValueError, QuietarmError) as error:
            self._say(str(error), RED)
        self._show()
        return self._explored is not before

    def _say(self, words: str, colour: str = GREY) -> None:
        self._said.text = f'<span style="color: {colour}">{escape(words)}</span>'

    def _show(self) -> None:
        """Bring everything on the page to the motion in hand."""
        explored = self._explored
        self._fill()
        self._figures.text = "".join(
            f"<div><b>{escape(name)}</b> {escape(value)}</div>" for name, value in _facts(explored)
        )
        self._plots.show(explored)

    def _fill(self) -> None:
        """Show in every field what is held."""
        self._filling = True
        dials, shown = self._explored.dials, self._explored.shown
        for name, fields in self._fields.items():
            for field in fields:
                if isinstance(field, Slider):
                    field.update(start=dials[name].least, end=dials[name].most)
                if field.value != shown[name]:
                    field.update(value=shown[name])
        self._plant.value = moved(self._explored.task)
        self._filling = False


def _facts(explored: Explored) -> Iterator[tuple[str, str]]:
    """The figures of `quietarm plan`, in the words of the page."""
    facts = next(one for one in plan_document(explored.plan).blocks if isinstance(one, Facts))
    for name, value in facts.rows:
        if name == "time":
            yield "computed in", value
        elif name == "status" and explored.of_front:
            yield name, "a point of the front"
        else:
            yield name, value.replace(HARD_REMEDY, "enter what the drive can do under Limits")


def _button(label: str, pressed: Callable[[], None], **look: Any) -> Button:
    button = Button(label=label, **look, **_WIDE)
    button.on_click(pressed)
    return button


def _in_twos(elements: Sequence[UIElement]) -> list[UIElement]:
    return [row(*elements[i : i + 2], **_WIDE) for i in range(0, len(elements), 2)]


def _step(dial: Dial) -> float:
    """A power of ten, a five-hundredth of the range or less."""
    return float(10 ** math.floor(math.log10((dial.most - dial.least) / 500)))
