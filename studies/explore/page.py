"""The page: fields and sliders that change the motion in hand, and what is shown of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

from bokeh.document import Document
from bokeh.models import (
    Button,
    Column,
    ColumnDataSource,
    CustomJS,
    Div,
    GridBox,
    Row,
    Select,
    Slider,
    Spinner,
    UIElement,
)
from bokeh.themes import Theme
from jinja2 import Environment, PackageLoader
from quietarm.models import Plant
from quietarm.ocp import QuietarmError
from quietarm.studies.explore.move import FILES, Dial, Explored
from quietarm.studies.explore.plots import GREY, PANELS, Plots
from quietarm.studies.figures.looks import RED
from quietarm.studies.registry.profiles import FAMILIES
from quietarm.studies.report.moves import plan_rows
from quietarm.studies.report.words import moved

Change = Callable[[Explored], Explored]
_WAIT = 5
"""Milliseconds in which changes are gathered: a slider sends more of them than are drawn."""
_WORK = ThreadPoolExecutor(1, "explore")
"""Where plans and fronts are computed, while the page goes on."""
_FORMAT = "0[.][0000]"
_FOLLOW = "if (cb_obj.value !== null) other.value = cb_obj.value"
_HERE = Path(__file__).parent


class Page:
    """One visitor's page: the motion in hand, and plants that can be chosen by their words."""

    def __init__(self, document: Document, explored: Explored, plants: Mapping[str, Plant]) -> None:
        self._document, self._explored, self._plants = document, explored, plants
        self._pending: dict[str, float | None] = {}
        self._filling, self._saved, self._sliders = False, 0, (list[str](), 0.0)
        self._fields: dict[str, Any] = {}
        self._shape, self._figures = (Column(name="shape"), Div(name="figures"))
        self._plots = Plots(document, explored.task.plant.joint, self._pick)
        self._file = ColumnDataSource({"name": [], "text": [], "number": []})
        self._file.js_on_change(
            "data", CustomJS(args={"file": self._file}, code=(_HERE / "save.js").read_text())
        )
        # as a tag it is part of the document
        self._said = Div(name="said", tags=[self._file])
        families: Any = list(dict.fromkeys([*FAMILIES, explored.profile]))
        self._choices: dict[str, Any] = {
            "plant": Select(title="plant", options=list(plants)),
            "profile": Select(title="profile", options=families),
            "terms": Spinner(title="terms", low=1, step=1),
        }
        for name, field in self._choices.items():
            field.on_change("value", partial(self._chosen, name))
        pressed = {
            "Plan": self._plan, "Front": self._front,
            "Plain cycloid": partial(self._change, Explored.begin_again),
            "Keep curve": partial(self._change, Explored.keep),
        }  # fmt: skip
        self._buttons = [_button(*one) for one in pressed.items()]
        self._buttons[0].button_type = "primary"
        for root in self._roots():
            document.add_root(root)
        document.title = "quietarm explore"
        document.theme = Theme(_HERE / "theme.yaml")
        loader = PackageLoader("quietarm.studies", "explore")
        document.template = Environment(loader=loader, autoescape=True).get_template("page.html")
        document.template_variables["panels"] = PANELS
        self._disable(False)
        self._show()

    def _roots(self) -> list[UIElement]:
        """What the template puts into its places, by name."""
        plant, *others = self._choices.values()
        move, limits = list[UIElement](), list[UIElement]()
        for name, dial in self._explored.dials.items():
            if dial.optional:
                limits.append(self._field(name, dial, placeholder="none"))
            elif name not in self._explored.coefficients:
                move.append(self._slider(name, dial))
        files = [_button(name, partial(self._save, name)) for name in FILES]
        answers = [plant, Row(children=others), _in_twos(self._buttons)]
        return [
            self._said, self._figures, *self._plots.roots, self._shape,
            Column(children=answers, name="answers"), Column(children=move, name="move"),
            _in_twos(limits, "limits"), _in_twos(files, "files"),
        ]  # fmt: skip

    def _field(self, name: str, dial: Dial, **look: Any) -> Spinner:
        field = Spinner(title=dial.label, format=_FORMAT, **look)
        field.on_change("value", partial(self._typed, name))
        return self._fields.setdefault(name, field)

    def _slider(self, name: str, dial: Dial) -> UIElement:
        """A field, and a slider that follows it and is followed."""
        step = float(10 ** math.floor(math.log10((dial.most - dial.least) / 500)))
        value = self._explored.shown[name] or 0.0
        field = self._field(name, dial, value=value, step=step, width=95, sizing_mode="fixed")
        slider = Slider(start=dial.least, end=dial.most, value=value, step=step, show_value=False,
                        align="end")  # fmt: skip
        for one, other in ((field, slider), (slider, field)):
            one.js_on_change("value", CustomJS(args={"other": other}, code=_FOLLOW))
        return Row(children=[field, slider])

    def _typed(self, name: str, attribute: str, old: Any, new: float | None) -> None:
        if self._filling:
            return
        if not self._pending:
            self._document.add_timeout_callback(self._take, _WAIT)
        self._pending[name] = new

    def _take(self) -> None:
        self._change(lambda same: same)

    def _chosen(self, name: str, attribute: str, old: Any, new: Any) -> None:
        changes: dict[str, Change] = {
            "plant": lambda explored: explored.choose_plant(self._plants[new]),
            "profile": lambda explored: explored.choose_profile(new),
            "terms": lambda explored: explored.choose_profile(explored.profile, new),
        }
        if not self._filling:
            self._change(changes[name])

    def _pick(self, number: int) -> None:
        self._change(lambda explored: explored.pick(number))

    def _save(self, name: str) -> None:
        if self._change(lambda same: same):
            self._saved += 1  # so that the same file can be saved again
            text = self._explored.file(name)
            self._file.data = {"name": [name], "text": [text], "number": [self._saved]}

    def _plan(self) -> None:
        self._begin(Explored.solve, "solving ...")

    def _front(self) -> None:
        def report(done: int, total: int) -> None:
            words = f"front: {done} of {total} points"
            self._document.add_next_tick_callback(lambda: self._say(words))

        then = "click a point of the front to see its motion"
        self._begin(lambda explored: explored.find_front(report), "front ...", then)

    def _begin(self, work: Change, words: str, then: str = "") -> None:
        """Compute something beside the page, on which nothing can be set until it is there."""

        def ended(future: Future[Explored]) -> None:
            self._disable(False)
            self._change(lambda _: future.result(), then)

        def done(future: Future[Explored]) -> None:
            self._document.add_next_tick_callback(lambda: ended(future))

        if self._change(lambda same: same):
            self._say(words)
            self._disable(True)
            _WORK.submit(work, self._explored).add_done_callback(done)

    def _disable(self, at_work: bool) -> None:
        for field in (*self._buttons, *self._fields.values()):
            field.disabled = at_work
        for field in self._choices.values():
            field.disabled = at_work or self._explored.library is not None

    def _change(self, change: Change, then: str = "") -> bool:
        """Change the motion in hand, after what was gathered; False where it is said why not."""
        pending, self._pending = self._pending, {}
        try:
            now = self._explored.change(pending) if pending else self._explored
            self._explored, words, colour = change(now), then, GREY
        except (ValueError, QuietarmError) as error:
            words, colour = str(error), RED
        self._show()
        self._say(words, colour)  # when all is shown
        return colour == GREY

    def _say(self, words: str, colour: str = GREY) -> None:
        self._said.text = f'<span style="color: {colour}">{escape(words)}</span>'

    def _show(self) -> None:
        """Bring everything on the page to the motion in hand."""
        explored, self._filling = self._explored, True
        sliders = list(explored.coefficients), explored.reach
        if sliders != self._sliders:
            for name in self._sliders[0]:
                del self._fields[name]
            self._sliders = sliders
            self._shape.children = [self._slider(name, explored.dials[name]) for name in sliders[0]]
        for name, field in self._fields.items():
            field.value = explored.shown[name]
        choices = {"plant": moved(explored.task), "profile": explored.profile,
                   "terms": getattr(explored.plan.profile, "terms", None)}  # fmt: skip
        for name, value in choices.items():
            self._choices[name].value = value
        self._filling = False
        self._figures.text = _facts(explored)
        kept = explored.kept is explored.plan
        self._buttons[-1].label = "Drop curve" if kept else "Keep curve"
        self._plots.show(explored)


def _facts(explored: Explored) -> str:
    """The figures of `quietarm plan`, in the words of the page."""
    facts = dict(plan_rows(explored.plan, "enter what the drive can do under Limits"))
    facts["computed in"] = facts.pop("time")
    if explored.of_front:
        facts["status"] = "a point of the front"
    lines = (f"<div><b>{escape(name)}</b> {escape(value)}</div>" for name, value in facts.items())
    return "".join(lines)


def _button(label: str, pressed: Callable[[], Any]) -> Button:
    button = Button(label=label)
    button.on_click(pressed)
    return button


def _in_twos(elements: Sequence[UIElement], name: str | None = None) -> UIElement:
    places: Any = [(one, k // 2, k % 2) for k, one in enumerate(elements)]
    return GridBox(children=places, name=name)
