"""The page alive: what it begins with, and what it is answered when something on it is set.

Every question holds all that was set, so that nothing is remembered of a visitor. The plans and
fronts of the latest questions are kept, since a download or a click on a front asks for them again.
"""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from contextlib import suppress
from typing import Any, NamedTuple, TypeVar

import msgspec
import numpy as np

from quietarm.models import Plant
from quietarm.ocp import Front, Plan, evaluate_coefficients, evaluate_robustness
from quietarm.ocp.planning.named_profiles import families
from quietarm.ocp.told_progress import Progress, no_report
from quietarm.ocp.uncertainty import FREQUENCY, check_ranges
from quietarm.views.explore.by_hand import (
    FILES,
    MoveByHand,
    Question,
    menu,
    plain_of,
    words_of_plant,
)
from quietarm.views.page.page_moves import KnownPoints, Move, move_by_hand, moves_of
from quietarm.views.page.trade_off import colour_name, page_html, shown_move
from quietarm.views.pictures.grammar import looks
from quietarm.views.pictures.motion import drawn_quantities
from quietarm.views.report.plan_rows import HARD_REMEDIES, plan_rows
from quietarm.views.report.words import raised
from quietarm.views.tips import tip_scale

T = TypeVar("T")
_FIRST_DRAWN = ("deflection", "torque", "power")
"""The panels that the page begins with; all others that can be drawn follow."""
_BYTES = 400_000
"""Of a motion or a front; curves that need more are coarser."""
_ERRORS = (0.2, 0.1, 0.05)
"""Largest errors of the frequency that are looked at, down to the first that the plant can have."""
_KEPT = 8
"""Plans and fronts of the latest questions."""


class _Traced(NamedTuple):
    """A front, and its motions that can be chosen."""

    front: Front
    move: Move


class LivePage:
    """The page of one plant, plan, front or library of moves.

    Parameters
    ----------
    begun : MoveByHand
        What it begins with.
    known_points : callable, optional
        Known points of a task's fronts of some numbers of terms; they lie beside a front.
    """

    def __init__(self, begun: MoveByHand, known_points: KnownPoints | None = None) -> None:
        self._begun = begun
        self._known_points = known_points
        self._plants: Mapping[str, Plant] = menu(begun.task.plant)
        if begun.library:
            self._plants = {words_of_plant(begun.task.plant): begun.task.plant}
        self._kept = OrderedDict[Hashable, Any]()
        self._opened = begun.front and self._with_motions(begun.front)
        self._answers: Mapping[str, Callable[[Question, Progress], dict[str, Any]]] = {
            "motion": lambda question, _: self._motion(question),
            "rows": lambda question, _: {"rows": _rows(self._asked(question))},
            "robustness": lambda question, _: {"robustness": _robustness(self._asked(question))},
            "front": self._front,
            **{name: self._file(name) for name in FILES},
        }

    @property
    def paths(self) -> frozenset[str]:
        """The paths of all questions that have an answer."""
        return frozenset(self._answers)

    def html(self) -> str:
        """The page as it begins."""
        begun = self._motion(Question())
        front = self._opened and _shown_front(self._opened)
        kept = looks(["plan", "plan"])[1]
        profiles = dict.fromkeys([*families(), self._begun.family])
        alive = {
            **begun,
            "front": front,
            "traces": front is None and self._traces_at_first,
            "plants": list(self._plants),
            "profiles": [self._begun.family] if self._begun.library else list(profiles),
            "fixed": self._begun.library is not None,
            "files": list(FILES),
            "kept": {"colour": colour_name(kept), "mark": kept.mark, "filled": True},
        }
        return page_html("quietarm explore", [begun["move"]], alive)

    @property
    def _traces_at_first(self) -> bool:
        """True if the front of the first move is known within seconds: of one joint, to be set."""
        return self._begun.library is None and len(self._begun.task.plant.joint_names) == 1

    def answer(self, path: str, body: bytes, report: Progress) -> dict[str, Any]:
        """Answer what one of `paths` is asked, in JSON; of a front `report` is told how far it is.

        ValueError or QuietarmError where there is no such motion; the text is for the visitor.
        """
        try:
            question = msgspec.json.decode(body, type=Question)
        except msgspec.DecodeError as error:
            raise ValueError(f"the page asks what is no question: {error}; load it again") from None
        return self._answers[path](question, report)

    def _asked(self, question: Question) -> MoveByHand:
        """The motion of a question."""
        move = self._begun.asked(question, self._plants)
        if question.optimal:
            return self._latest(("plan", _key(question)), move.solve)
        if question.point is not None:
            traced = self._traced(question, move, no_report)
            choices = traced.move.choices
            if not 0 <= question.point < len(choices):
                raise ValueError(f"the front has no point {question.point}; draw it again")
            return move.pick(traced.front, choices[question.point].plan.coefficients)
        return move

    def _motion(self, question: Question) -> dict[str, Any]:
        """The motion that is shown, and the fields."""
        asked = self._asked(question)
        cycloid = self._latest(asked.task, lambda: evaluate_coefficients(asked.task, []))
        move = move_by_hand(asked.motion, cycloid)
        return {
            "move": shown_move(move, _BYTES, quantities=_drawn()),
            "fields": _fields(asked),
        }

    def _front(self, question: Question, report: Progress) -> dict[str, Any]:
        """The front of a move, with all of its motions."""
        move = self._begun.asked(question, self._plants)
        return {"front": _shown_front(self._traced(question, move, report))}

    def _traced(self, question: Question, move: MoveByHand, report: Progress) -> _Traced:
        """The front of a move: the one that the page began with, a recent one, or a new one."""
        if move.front is not None and self._opened is not None:
            return self._opened
        others = {*move.coefficient_names, "residual_limit"}
        values = {name: value for name, value in question.values.items() if name not in others}
        of_front = msgspec.structs.replace(question, optimal=False, point=None, values=values)
        return self._latest(
            ("front", _key(of_front)), lambda: self._with_motions(move.find_front(report))
        )

    def _with_motions(self, front: Front) -> _Traced:
        (move,) = moves_of({"front": front}, self._known_points)
        return _Traced(front, move)

    def _file(self, name: str) -> Callable[[Question, Progress], dict[str, Any]]:
        return lambda question, _: {"name": name, "text": self._asked(question).file(name)}

    def _latest(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Return the answer to a question: a kept one, or one that is computed now."""
        if key not in self._kept:
            self._kept[key] = compute()
        self._kept.move_to_end(key)
        while len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return self._kept[key]


def _drawn() -> tuple[str, ...]:
    """Return the names of all panels over time, those of a user's own quantities included."""
    return tuple(dict.fromkeys([*_FIRST_DRAWN, *drawn_quantities()]))


def _shown_front(traced: _Traced) -> dict[str, Any]:
    """Return all that the scripts need of a front, and the coefficients of its motions."""
    coefficients = [[*map(float, choice.plan.coefficients)] for choice in traced.move.choices]
    shown = shown_move(traced.move, _BYTES, quantities=_drawn())
    return {**shown, "coefficients": coefficients}


def _key(question: Question) -> str:
    """Return a text that is the same for equal questions."""
    return json.dumps(msgspec.to_builtins(question), sort_keys=True)


def _rows(asked: MoveByHand) -> list[list[str]]:
    """The figures of `quietarm plan`, in the words of the page."""
    remedies = dict.fromkeys(HARD_REMEDIES, "enter what the drive can do under Limits")
    rows = dict(plan_rows(asked.motion, remedies, verbose=True))
    rows["computed in"] = rows.pop("time")
    if asked.is_of_front:
        rows["status"] = "a point of the front"
    return [[name, raised(words)] for name, words in rows.items()]


def _fields(asked: MoveByHand) -> dict[str, Any]:
    """Return the fields of the page: values, ranges, and the coefficients of the plain motion."""
    return {
        "shown": asked.shown,
        "dials": [
            {"name": name, "label": dial.label, "least": dial.least, "most": dial.most,
             "step": dial.step, "group": dial.group}
            for name, dial in asked.dials.items()
        ],
        "plain": plain_of(asked.profile),
    }  # fmt: skip


def _robustness(asked: MoveByHand) -> dict[str, Any]:
    """The residual over the error of the frequency, and what is tolerated."""
    plan = asked.motion
    unit, scale = tip_scale(plan.task.plant.tip_unit)
    robustness = evaluate_robustness(plan.candidate, {FREQUENCY: _error_of(plan)}, samples=1)
    (sweep,) = robustness.sweeps
    return {
        "unit": unit,
        "errors": np.round(100 * sweep.errors, 3).tolist(),
        "residuals": (scale * sweep.figures.residual).tolist(),
        "tolerated": scale * robustness.tolerated,
    }


def _error_of(plan: Plan) -> float:
    """Find the largest error of the frequency that a plant can have: a robot's tables end."""
    for error in _ERRORS[:-1]:
        with suppress(ValueError):
            check_ranges(plan.task.plant, {FREQUENCY: error})
            return error
    return _ERRORS[-1]
