"""Every system on one move: what the paper compares itself with, its own, and what is used instead.

A new system is one entry of `systems_of`; what it has to solve is a piece of `pieces`.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from quietarm.metaheuristics.ensemble import Spread
from quietarm.ocp import (
    Floor,
    Motion,
    Plan,
    evaluate_coefficients,
    shaped_cycloid,
)
from quietarm.ocp.uncertainty import FREQUENCY
from quietarm.studies.display.words import millimetres
from quietarm.studies.paper import ROWS, Case, paper_plan
from quietarm.studies.registry.methods import Method
from quietarm.studies.registry.profiles import OTHERS
from quietarm.studies.reproduction.searches import COMPARED_TERMS, SEARCHES, Searched

COMPARED_SHAPERS = ("zv", "zvd", "ei")
FREQUENCY_ERROR = 0.1
"""Relative error of the plant's natural frequencies."""
CYCLOID, PAPER, IN_BOX, FREE, ROBUST, FLOOR = (
    "plain cycloid", "paper", "boxed gradient", "gradient", "robust plan", "floor",
)  # fmt: skip


@dataclass(frozen=True)
class System:
    """What one system makes of a move."""

    name: str
    parameters: int | None = None
    motion: Motion | None = None
    wrong_residual: float | None = None
    turns_back: float | None = None
    seconds: float | None = None
    printed_energy: float | None = None
    energies: Spread | None = None
    why: str = ""

    @property
    def energy(self) -> float | None:
        """F2 [J]: of the motion, else as printed."""
        return self.printed_energy if self.motion is None else self.motion.energy

    @property
    def residual(self) -> float | None:
        """F1 [m]."""
        return self.motion and self.motion.residual

    @property
    def peak_torque(self) -> float | None:
        """Largest torque of the joint [N m]."""
        return self.motion and self.motion.peak_torque

    @property
    def peak_acceleration(self) -> float | None:
        """Largest acceleration of the joint [rad/s^2]."""
        return self.motion and self.motion.peak_acceleration


Systems = Mapping[Case, Sequence[System]]


def systems_of(case: Case, answers: Mapping[Hashable, Any], seeds: int) -> tuple[System, ...]:
    """Every system on a move, always in the same order."""
    return (
        replace(_of(CYCLOID, evaluate_coefficients(case.task, [])), seconds=None),
        *(_shaped(case, shaper) for shaper in COMPARED_SHAPERS),
        _paper(case),
        *(_of(name, answers[case, name]) for name in OTHERS),
        *(
            searched(method, Searched.among(answers, method, case, COMPARED_TERMS, seeds))
            for method in SEARCHES
        ),
        _of(IN_BOX, answers[case, COMPARED_TERMS, True]),
        _of(FREE, answers[case, COMPARED_TERMS, False]),
        _robust(case, answers[case, ROBUST]),
        _of(FLOOR, answers[case]),
    )


def _of(name: str, answer: Plan | Floor) -> System:
    size = answer.profile.size if isinstance(answer, Plan) else None
    errors = ({FREQUENCY: error} for error in (-FREQUENCY_ERROR, FREQUENCY_ERROR))
    wrong = max(answer.candidate.perturbed(one).residual for one in errors)
    back = answer.turns_back if isinstance(answer, Plan) else None
    return System(name, size, answer.motion, wrong, back, answer.provenance.seconds)


def _robust(case: Case, plan: Plan | str) -> System:
    """On the assumed plant, as all others are."""
    if isinstance(plan, str):
        return System(ROBUST, COMPARED_TERMS, why=plan)
    assumed = evaluate_coefficients(case.task, plan.coefficients, profile=plan.profile)
    return replace(_of(ROBUST, assumed), seconds=plan.provenance.seconds)


def _shaped(case: Case, shaper: str) -> System:
    name = shaper.upper()
    try:
        profile = shaped_cycloid(case.task, shaper)
    except ValueError as too_short:
        return System(name, why=str(too_short))
    plan = evaluate_coefficients(case.task, [], profile=profile)
    return replace(_of(name, plan), seconds=None)


def _paper(case: Case) -> System:
    plan = paper_plan(case, COMPARED_TERMS)
    if plan is not None:
        return replace(_of(PAPER, plan), seconds=None)
    energies = [r.energy for r in ROWS if (r.condition, r.terms) == (case, COMPARED_TERMS)]
    if not energies:
        return System(PAPER, why="the paper has no such move")
    why = "the paper prints the energy, not the coefficients"
    return System(PAPER, COMPARED_TERMS, printed_energy=energies[0], why=why)


def searched(method: Method, found: Searched) -> System:
    """The middle one of a search's seeds."""
    if found.middle is None:
        seed = "no point" if len(found.fronts) == 1 else "at the middle seed no point"
        why = f"{seed} of its front is within {millimetres(found.level)}"
        return System(method.label, COMPARED_TERMS, energies=found.energies, why=why)
    return replace(_of(method.label, found.middle), energies=found.energies)
