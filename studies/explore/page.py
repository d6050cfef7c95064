"""The page: fields and sliders that change the motion in hand, and what is shown of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from html import escape
from itertools import chain
from typing import Any

from bokeh.document import Document
from bokeh.layouts import column, row
from bokeh.models import Button, ColumnDataSource, CustomJS, Div, Select, Slider, Spinner, UIElement
from jinja2 import Environment, PackageLoader
from quietarm.models import Plant
from quietarm.ocp import QuietarmError
from quietarm.studies.explore.move import FILES, Dial, Explored
from quietarm.studies.explore.plots import GREY, PANELS, Plots
from quietarm.studies.figures.looks import RED
from quietarm.studies.registry.profiles import FAMILIES
from quietarm.studies.report.moves import HARD_REMEDY, plan_rows
from quietarm.studies.report.words import moved

_WAIT = 5
"""Milliseconds in which changes are gathered: a slider sends more of them than are drawn."""
_WORK = ThreadPoolExecutor(1, "explore")
"""Where plans and fronts are computed, while the page goes on."""
_WIDE: Mapping[str, Any] = {"sizing_mode": "stretch_width"}
_SAVE = """
const link = document.createElement("a");
link.href = URL.createObjectURL(new Blob([file.data.text[0]], {type: "text/plain"}));
link.download = file.data.name[0];
link.click();
URL.revokeObjectURL(link.href);
"""


class Page:
    """One visitor's page: the motion in hand, and plants that can be chosen by their words."""

    def __init__(self, document: Document, explored: Explored, plants: Mapping[str, Plant]) -> None:
        self._document, self._explored = document, explored
        self._pending: dict[str, float | None] = {}
        self._filling, self._saved = False, 0
        self._fields: dict[str, list[Any]] = {}
        self._coefficients = list[str]()
        self._figures, self._shape = Div(name="figures", **_WIDE), column(name="shape", **_WIDE)
        self._plots = Plots(document, self._on_pick)
        self._file = ColumnDataSource({"name": [], "text": [], "number": []})
        self._file.js_on_change("data", CustomJS(args={"file": self._file}, code=_SAVE))
        # as a tag it is part of the document
        self._said = Div(name="said", tags=[self._file], **_WIDE)
        families: Any = list(dict.fromkeys([*FAMILIES, explored.profile]))
        self._plant = Select(title="plant", options=list(plants), **_WIDE)
        self._profile = Select(title="profile", options=families, **_WIDE)
        self._terms = Spinner(title="terms", low=1, step=1, **_WIDE)
        self._hear(self._plant, lambda name: self._explored.choose_plant(plants[name]))
        self._hear(self._profile, lambda name: self._explored.choose_profile(name))
        self._hear(self._terms, lambda terms: self._explored.choose_terms(terms))
        self._buttons = [
            _button("Plan", self._on_plan, button_type="primary"),
            _button("Front", self._on_front),
            _button("Plain cycloid", lambda: self._change(lambda: self._explored.begin_again())),
            _button("Keep curve", lambda: self._change(lambda: self._explored.keep())),
        ]
        for root in self._roots():
            document.add_root(root)
        document.title = "quietarm explore"
        loader = PackageLoader("quietarm.studies", "explore")
        document.template = Environment(loader=loader, autoescape=True).get_template("page.html")
        document.template_variables["panels"] = PANELS
        self._disable(False)
        self._show()

    def _roots(self) -> list[UIElement]:
        """What the template puts into its places, by name."""
        dials = self._explored.dials
        move = [self._slider(name, dial) for name, dial in dials.items()
                if not dial.optional and name not in self._explored.coefficients]  # fmt: skip
        limits = [self._limit(name, dial) for name, dial in dials.items() if dial.optional]
        files = [_button(name, partial(self._on_file, name)) for name in FILES]
        answers = [self._plant, row(self._profile, self._terms, **_WIDE), *_in_twos(self._buttons)]
        return [
            self._said, self._figures, *self._plots.roots, self._shape,
            column(*answers, name="answers", **_WIDE),
            column(*move, name="move", **_WIDE),
            column(*_in_twos(limits), name="limits", **_WIDE),
            column(*_in_twos(files), name="files", **_WIDE),
        ]  # fmt: skip

    def _hear(self, field: Any, change: Callable[[Any], Explored]) -> None:
        """Have a field choose what else is changed by hand."""

        def heard(attribute: str, old: Any, new: Any) -> None:
            if not self._filling:
                self._change(lambda: change(new))

        field.on_change("value", heard)

    def _slider(self, name: str, dial: Dial) -> UIElement:
        """A field, and a slider for the same number."""
        step = float(10 ** math.floor(math.log10((dial.most - dial.least) / 500)))
        field = Spinner(title=dial.label, step=step, format="0[.][0000]", width=95)
        slider = Slider(
            start=dial.least, end=dial.most, value=dial.least, step=step, show_value=False,
            align="end", **_WIDE,
        )  # fmt: skip
        self._fields[name] = [self._on_hand(name, field), self._on_hand(name, slider)]
        return row(field, slider, **_WIDE)

    def _limit(self, name: str, dial: Dial) -> UIElement:
        """A field that may be empty."""
        field = Spinner(title=dial.label, format="0[.][0000]", placeholder="none", **_WIDE)
        self._fields[name] = [self._on_hand(name, field)]
        return field

    def _on_hand(self, name: str, field: Any) -> Any:
        def heard(attribute: str, old: float | None, new: float | None) -> None:
            if self._filling:
                return
            if not self._pending:
                self._document.add_timeout_callback(self._on_time, _WAIT)
            self._pending[name] = new

        field.name = f"{name}-{type(field).__name__.lower()}"
        field.on_change("value", heard)
        return field

    def _on_time(self) -> None:
        self._set()

    def _set(self) -> bool:
        """Set what was gathered; False where that cannot be."""
        pending, self._pending = self._pending, {}
        return not pending or self._answer(lambda: self._explored.change(pending))

    def _on_pick(self, number: int) -> None:
        self._change(lambda: self._explored.pick(number))

    def _on_file(self, name: str) -> None:
        if self._set():
            self._saved += 1  # so that the same file can be saved again
            text = self._explored.file(name)
            self._file.data = {"name": [name], "text": [text], "number": [self._saved]}

    def _on_plan(self) -> None:
        if self._set():
            self._begin(self._explored.solve, "solving ...")

    def _on_front(self) -> None:
        def report(done: int, total: int) -> None:
            words = f"front: {done} of {total} points"
            self._document.add_next_tick_callback(lambda: self._say(words))

        if self._set():
            work = partial(self._explored.find_front, report)
            self._begin(work, "front ...", "click a point of the front to see its motion")

    def _begin(self, work: Callable[[], Explored], words: str, then: str = "") -> None:
        """Compute something beside the page, on which nothing can be set until it is there."""

        def ended(future: Future[Explored]) -> None:
            self._disable(False)
            self._answer(future.result, then)

        def done(future: Future[Explored]) -> None:
            self._document.add_next_tick_callback(lambda: ended(future))

        self._say(words)
        self._disable(True)
        _WORK.submit(work).add_done_callback(done)

    def _disable(self, at_work: bool) -> None:
        for field in (*self._buttons, *chain(*self._fields.values())):
            field.disabled = at_work
        for field in (self._plant, self._profile, self._terms):
            field.disabled = at_work or self._explored.library is not None

    def _change(self, change: Callable[[], Explored]) -> None:
        """Change the motion in hand, after what was gathered."""
        if self._set():
            self._answer(change)

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
        self._fill()
        self._figures.text = "".join(
            f"<div><b>{escape(name)}</b> {escape(value)}</div>"
            for name, value in _facts(self._explored)
        )
        kept = self._explored.kept is self._explored.plan
        self._buttons[-1].label = "Drop curve" if kept else "Keep curve"
        self._plots.show(self._explored)

    def _fill(self) -> None:
        """Show in every field what is held; there is a slider for each coefficient."""
        self._filling = True
        explored = self._explored
        names, dials, shown = list(explored.coefficients), explored.dials, explored.shown
        if names != self._coefficients:
            for name in self._coefficients:
                del self._fields[name]
            self._coefficients = names
            self._shape.children = [self._slider(name, dials[name]) for name in names]
        for name, fields in self._fields.items():
            for field in fields:
                if isinstance(field, Slider):
                    field.update(start=dials[name].least, end=dials[name].most)
                if field.value != shown[name]:
                    field.update(value=shown[name])
        self._plant.value, self._profile.value = moved(explored.task), explored.profile
        self._terms.value = getattr(explored.plan.profile, "terms", None)
        self._filling = False


def _facts(explored: Explored) -> list[tuple[str, str]]:
    """The figures of `quietarm plan`, in the words of the page."""
    of_front = {"status": "a point of the front"} if explored.of_front else {}
    return [
        ("computed in" if name == "time" else name, of_front.get(name, value).replace(
            HARD_REMEDY, "enter what the drive can do under Limits"))
        for name, value in plan_rows(explored.plan)
    ]  # fmt: skip


def _button(label: str, pressed: Callable[[], None], **look: Any) -> Button:
    button = Button(label=label, **look, **_WIDE)
    button.on_click(pressed)
    return button


def _in_twos(elements: Sequence[UIElement]) -> list[UIElement]:
    return [row(*elements[i : i + 2], **_WIDE) for i in range(0, len(elements), 2)]
