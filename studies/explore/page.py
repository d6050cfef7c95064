"""The page: fields and sliders that change the motion in hand, and what is shown of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
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
from quietarm.ocp.escapes import html_text
from quietarm.ocp.planning.named_profiles import families
from quietarm.studies.explore.move import FILES, Dial, Explored
from quietarm.studies.explore.plots import PANELS, Plots
from quietarm.views.pictures.grammar import INK, RED
from quietarm.views.pictures.meaning import is_plain_cycloid
from quietarm.views.report.plan_rows import HARD_REMEDIES, plan_rows
from quietarm.views.report.words import raised

Change = Callable[[Explored], Explored]
_WAIT = 5
"""Milliseconds in which changes are gathered: a slider sends more of them than are drawn."""
_WORK = ThreadPoolExecutor(1, "explore")
"""Where plans and fronts are computed, while the page goes on."""
_HERE = Path(__file__).parent
_FINE = (_HERE / "fine.js").read_text(encoding="utf-8")
"""Sliders that go in small steps with the shift key."""


class Page:
    """One visitor's page: the motion in hand, and plants that can be chosen by their words."""

    def __init__(self, document: Document, explored: Explored, plants: Mapping[str, Plant]) -> None:
        self._document = document
        self._explored = explored
        self._typed = dict[str, Any]()
        self._fields = dict[str, Any]()
        self._choices: dict[str, Callable[[Explored, Any], Explored]] = {
            "plant": lambda now, words: now.choose_plant(plants[words]),
            "profile": Explored.choose_profile,
            "terms": lambda now, terms: now.choose_profile(now.profile, terms),
        }
        self._sliders: tuple[list[str], tuple[float, ...]] = [], ()
        self._plots = Plots(document, explored.task.plant, self._pick)
        self._file = ColumnDataSource({"name": [], "text": [], "time": []})
        save = CustomJS(args={"file": self._file}, code=(_HERE / "save.js").read_text())
        self._file.js_on_change("data", save)
        self._shape = Column(name="shape")
        self._figures = _words("figures")
        self._key = _words("key", styles={"color": "#57606a", "font-size": ".85rem"})
        self._said = _words("said", tags=[self._file])  # it is part of the document as a tag
        self._buttons = [
            _button(
                "Plan", partial(self._begin, Explored.solve, "solving ..."), button_type="primary"
            ),
            _button("Front", self._front),
            _button("Plain cycloid", partial(self._change, Explored.begin_again)),
            _button("Keep curve", partial(self._change, Explored.keep)),
        ]
        with document.models.freeze():  # else all models are collected anew for every root
            for root in self._roots(plants):
                document.add_root(root)
        document.title = "quietarm explore"
        document.theme = Theme(_HERE / "theme.yaml")
        loader = PackageLoader("quietarm.studies", "explore")
        document.template = Environment(loader=loader, autoescape=True).get_template("page.html")
        document.template_variables["panels"] = PANELS
        self._disable(False)
        self._show()

    def _roots(self, plants: Mapping[str, Plant]) -> list[UIElement]:
        """What the template puts into its places, by name."""
        profiles: Any = list(dict.fromkeys([*families(), self._explored.profile]))
        plant = Select(title="plant", options=list(plants))
        profile = Select(title="profile", options=profiles)
        terms = Spinner(title="terms", low=1, step=1)
        for name, field in {"plant": plant, "profile": profile, "terms": terms}.items():
            self._watch(name, field)
        move = self._group("move")
        limits = _in_twos(self._group("limits"), "limits")
        files = [_button(name, partial(self._save, name)) for name in FILES]
        moved = Column(children=move, name="move")
        fine = CustomJS(args={"columns": [self._shape, moved]}, code=_FINE)
        self._document.js_on_event("document_ready", fine)
        answers = [plant, Row(children=[profile, terms]), _in_twos(self._buttons)]
        return [
            self._said, self._figures, self._key, *self._plots.roots, self._shape,
            Column(children=answers, name="answers"), moved, limits, _in_twos(files, "files"),
        ]  # fmt: skip

    def _watch(self, name: str, field: Any) -> None:
        """Take what is set in a field, with all that is set within a moment."""

        def typed(_: str, old: Any, new: Any) -> None:
            if not self._typed and _same(new, self._explored.shown[name]):
                return  # it was set by the page
            if not self._typed:
                change: Any = self._change  # what it returns is not asked for
                self._document.add_timeout_callback(change, _WAIT)
            self._typed[name] = new

        self._fields[name] = field
        field.on_change("value", typed)

    def _group(self, group: str) -> list[UIElement]:
        dials = self._explored.dials.items()
        return [self._field(name, dial) for name, dial in dials if dial.group == group]

    def _field(self, name: str, dial: Dial) -> UIElement:
        """A number; but for a limit with a slider that follows it and is followed."""
        follow = "if (cb_obj.value !== null) other.value = cb_obj.value"
        field = Spinner(title=dial.label, format="0[.][0000]", placeholder="none")
        self._watch(name, field)
        if dial.group == "limits":
            return field
        step = float(10 ** math.floor(math.log10((dial.most - dial.least) / 500)))
        slider = Slider(start=dial.least, end=dial.most, show_value=False, align="end")
        for source, target in ((field, slider), (slider, field)):
            source.js_on_change("value", CustomJS(args={"other": target}, code=follow))
            source.update(value=self._explored.shown[name] or 0.0, step=step)
        field.update(width=95, sizing_mode="fixed")
        return Row(children=[field, slider])

    def _pick(self, number: int) -> None:
        self._change(lambda explored: explored.pick(number))

    def _save(self, name: str) -> None:
        if self._change():
            text = self._explored.file(name)
            now = time.monotonic()
            # with the time the same file can be saved again
            self._file.data = {"name": [name], "text": [text], "time": [now]}

    def _front(self) -> None:
        def report(done: int, total: int) -> None:
            words = f"front: {done} of {total} points"
            self._document.add_next_tick_callback(partial(self._say, words))
            self._document.add_next_tick_callback(partial(self._plots.entitle_front, words))

        self._begin(lambda explored: explored.find_front(report), "front ...")

    def _begin(self, work: Change, words: str) -> None:
        """Compute something beside the page, on which nothing can be set until it is there."""

        def ended(future: Future[Explored]) -> None:
            self._disable(False)
            self._change(lambda _: future.result())

        if self._change():
            self._say(words)
            self._disable(True)
            tick = self._document.add_next_tick_callback
            future = _WORK.submit(work, self._explored)
            future.add_done_callback(lambda done: tick(partial(ended, done)))

    def _disable(self, at_work: bool) -> None:
        for name, field in self._fields.items():
            fixed = name in self._choices and self._explored.library is not None
            field.disabled = at_work or fixed
        for button in self._buttons:
            button.disabled = at_work

    def _change(self, change: Change = lambda same: same) -> bool:
        """Change the motion in hand, after what was typed; False where it is said why not."""
        typed = self._typed
        words = ""
        colour = INK
        self._typed = {}
        dials = {name: value for name, value in typed.items() if name not in self._choices}
        try:
            if dials:  # all at once: one after another could pass a move that is none
                self._explored = self._explored.change(dials)
            for name, choose in self._choices.items():
                if name in typed:
                    self._explored = choose(self._explored, typed[name])
            self._explored = change(self._explored)
        except (ValueError, QuietarmError) as error:
            words = str(error)
            colour = RED
        self._show()
        self._say(words, colour)  # when all is shown
        return colour == INK

    def _say(self, words: str, colour: str = INK) -> None:
        self._said.text = f'<span style="color: {colour}">{html_text(words)}</span>'

    def _show(self) -> None:
        """Bring everything on the page to the motion in hand."""
        explored = self._explored
        if self._sliders != (sliders := ([*explored.coefficients], explored.reach)):
            for name in self._sliders[0]:
                del self._fields[name]
            self._sliders = sliders
            self._shape.children = self._group("shape")
        for name, field in self._fields.items():
            if not _same(field.value, explored.shown[name]):
                field.value = explored.shown[name]
        self._figures.text = _facts(explored)
        self._key.text = _key(explored)
        self._buttons[-1].label = "Drop curve" if explored.kept is explored.plan else "Keep curve"
        self._plots.show(explored)


def _same(value: Any, shown: Any) -> bool:
    """Whether a field shows a value: a slider's steps add up to it but for rounding.

    What is set back for that alone meets the next moves of the slider, and none of them ends.
    """
    rounding = 1e-9
    if isinstance(value, float | int) and isinstance(shown, float | int):
        return math.isclose(value, shown, rel_tol=rounding, abs_tol=rounding)
    return value == shown


def _facts(explored: Explored) -> str:
    """The figures of `quietarm plan`, in the words of the page."""
    remedies = dict.fromkeys(HARD_REMEDIES, "enter what the drive can do under Limits")
    facts = dict(plan_rows(explored.plan, remedies))
    facts["computed in"] = facts.pop("time")
    if explored.of_front:
        facts["status"] = "a point of the front"
    lines = (
        f"<div><b>{html_text(name)}</b> {html_text(raised(value))}</div>"
        for name, value in facts.items()
    )
    return "".join(lines)


def _key(explored: Explored) -> str:
    """What the colours and lines are that can be seen now."""
    colour = "Green" if explored.task.ranges else "Blue"
    ring = "a dark ring on the front" if explored.front else "a ring where its front will be"
    words = [f"{colour}: this motion, {ring}"]
    if is_plain_cycloid(explored.plan):
        words[0] += "; it still is the plain cycloid"
    else:
        words.append("grey: the plain cycloid of the same move")
    if explored.kept:
        words.append("red, dashed: the curve that was kept")
    limits = "limits that the motion comes near, and " if explored.task.limits else ""
    words.append(f"dotted: {limits}5 % of the plain cycloid's residual, over the frequency error")
    return "; ".join(words) + ". After arrival curves are lighter."


def _words(name: str, **look: Any) -> Div:
    """A place for words, in which a dollar is no formula."""
    return Div(name=name, disable_math=True, **look)


def _button(label: str, pressed: Callable[[], Any], **look: Any) -> Button:
    button = Button(label=label, **look)
    button.on_click(pressed)
    return button


def _in_twos(elements: Sequence[UIElement], name: str | None = None) -> UIElement:
    places: Any = [(element, k // 2, k % 2) for k, element in enumerate(elements)]
    return GridBox(children=places, name=name)
