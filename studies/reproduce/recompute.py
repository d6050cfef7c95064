"""The paper as jobs: its searches, and what the gradient finds for the same moves."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Mapping
from dataclasses import astuple, dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import Any

from quietarm.metaheuristics import INERTIA_2002, search
from quietarm.metaheuristics.parallel import side_by_side
from quietarm.ocp import (
    CrossCheck,
    CycloidPolynomial,
    Floor,
    Front,
    Plan,
    SolverFailedError,
    Uncertainty,
    cross_check,
    energy_floor,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.record import versions
from quietarm.ocp.robustness.measures import tolerated_residual
from quietarm.studies.compare.judged import Judged, judge
from quietarm.studies.compare.plans import compare_plans
from quietarm.studies.reproduce.paper import CONDITIONS, ROWS, SIX, STUDIED, Case, paper_plan
from quietarm.studies.reproduce.searched import (
    OTHERS,
    SIX_TERMS,
    Input,
    Searched,
    profile_with,
)

BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
TERMS = (2, 4, SIX_TERMS, *BEYOND_SIX)
_CONSTANTS = ("inertia", "last_inertia", "constriction", "cognitive", "social")
VEPSO_2002 = dict(zip(_CONSTANTS, astuple(INERTIA_2002), strict=True))
"""Settings with the constants of Parsopoulos and Vrahatis; the paper names none."""
FREQUENCY_ERROR = {"frequency": 0.1}
_SHAPERS = ("cycloid", "zv", "zvd", "ei")


@dataclass(frozen=True)
class Effort:
    """How thoroughly the paper is recomputed.

    Attributes
    ----------
    full : bool
        All that the claims need, not the tables and figures alone.
    seeds : int
        Of every search.
    searches : mapping
        Settings of each search by its name, as population and generations; the paper's by default.
    starts : int
        Of the gradient.
    points : int
        Of the fronts that both solvers find.
    free_motion : mapping
        Settings of `energy_floor`.
    systems : sequence of Case
        Where every system stands side by side.
    """

    full: bool = False
    seeds: int = 1
    searches: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    starts: int = 4
    points: int = 50
    free_motion: Mapping[str, Any] = field(default_factory=dict)
    systems: tuple[Case, ...] = CONDITIONS

    @property
    def searched(self) -> list[tuple[Case, Input, bool]]:
        """What is searched: the case, the input, and whether by the constants of 2002."""
        chosen: dict[tuple[Case, Input], None] = {(row.condition, row.terms): None for row in ROWS}
        if self.full:
            chosen |= dict.fromkeys((case, case.earlier[1]) for case in CONDITIONS)
            chosen |= dict.fromkeys(product(STUDIED, BEYOND_SIX))
        return [*((*of, False) for of in chosen), *[(CONDITIONS[0], SIX_TERMS, True)] * self.full]


@dataclass(frozen=True)
class Reproduction:
    """All that `recompute_paper` computes."""

    effort: Effort
    searched: Mapping[tuple[Case, Input], Searched]
    by_constants_of_2002: Searched | None
    answers: Mapping[Hashable, Any]

    def cycloid(self, case: Case) -> Plan:
        """The plain cycloid."""
        return evaluate_coefficients(case.task, [])

    def in_box(self, case: Case, terms: int) -> Plan:
        """The gradient's plan in the paper's box."""
        return self.answers["in box", case, terms]

    def free(self, case: Case, terms: int) -> Plan:
        """The gradient's plan without a box."""
        return self.answers["no box", case, terms]

    def earlier(self, case: Case) -> Plan | None:
        """The gradient's plan with the earlier study's input; None where it was left out."""
        return self.answers.get(("other", case, case.earlier[1]))

    def floor(self, case: Case) -> Floor:
        """The best motion found without a parametrisation."""
        return self.answers["free motion", case]

    def check(self, case: Case) -> CrossCheck:
        """Its front by both solvers."""
        return self.answers["both solvers", case]

    @cached_property
    def systems(self) -> dict[Case, list[Judged]]:
        """Every system on the same moves, each judged alike; none without full effort."""
        cases = self.effort.systems if self.effort.full else ()
        return {case: list(self._judged(case)) for case in cases}

    def _judged(self, case: Case) -> list[Judged]:
        printed = next(row.energy for row in SIX if row.condition == case)
        middle = self.searched[case, SIX_TERMS].middle
        moved: dict[str, Plan | Floor | str] = {
            "paper": paper_plan(case, SIX_TERMS, mended=False)
            or f"prints {printed:.4g} J, and no coefficients",
            **{name: self.answers["other", case, name] for name in (case.earlier[1], "spline")},
            case.search_label: middle or "the middle seed has no such small residual",
            "gradient, in the box": self.in_box(case, SIX_TERMS),
            "gradient": self.free(case, SIX_TERMS),
            "robust plan": self.answers["robust", case],
            "free motion": self.floor(case),
        }
        return [
            *compare_plans({}, _SHAPERS, FREQUENCY_ERROR, 0, task=case.task),
            *(
                Judged(name, why=one) if isinstance(one, str)
                else judge(name, one, FREQUENCY_ERROR, case.task)
                for name, one in moved.items()
            ),
        ]  # fmt: skip


def recompute_paper(
    effort: Effort | None = None,
    workers: int = 1,
    report: Callable[[str], object] = lambda name: None,
    folder: Path | None = None,
) -> Reproduction:
    """Recompute the paper's tables and figures; with full effort what its claims need, too.

    Parameters
    ----------
    effort : Effort, optional
        How thoroughly; by default the tables and figures, with one seed.
    workers : int
        Processes that share the work.
    report : callable, optional
        Is told what is done, piece by piece; there are `number_of_pieces`.
    folder : path, optional
        Where the fronts of the searches are kept, each as soon as it is done. Those that are there
        are not searched again.
    """
    effort, answers = effort or Effort(), dict[Hashable, Any]()
    for key, name, answer in side_by_side(_done, list(_work(effort, folder).items()), workers):
        answers[key] = answer
        report(name)
    found = {
        of: Searched(*of[:2], tuple(answers[*of, seed] for seed in range(effort.seeds)))
        for of in effort.searched
    }
    searched = {of[:2]: one for of, one in found.items() if not of[2]}
    old = next((one for of, one in found.items() if of[2]), None)
    return Reproduction(effort, searched, old, answers)


def number_of_pieces(effort: Effort) -> int:
    """How many pieces of work there are."""
    return len(_work(effort, None))


_Piece = tuple[str, Callable[[], Any]]
"""A piece of work: its name, and what does it."""


def _done(item: tuple[Hashable, _Piece]) -> tuple[Hashable, str, Any]:
    key, (name, call) = item
    return key, name, call()


def _work(effort: Effort, folder: Path | None) -> dict[Hashable, _Piece]:
    """All work; the long searches first, so that in the end no worker waits long for another."""
    work: dict[Hashable, _Piece] = {}
    ordered = sorted(effort.searched, key=lambda of: of[0].search)
    for (case, which, old), seed in product(ordered, range(effort.seeds)):
        given = effort.searches.get(case.search, {})
        own = {"N": which, "constants": 2002, **given, "seed": seed}
        words = [f"{name} = {value}" for name, value in own.items() if old or name != "constants"]
        name = f"{case.search}: {', '.join([case.name, *words])}"
        call = partial(
            search, case.task, case.search, profile=profile_with(which), seed=seed,
            bound=case.bound if isinstance(which, int) else None,  # others have their own
            settings=VEPSO_2002 if old else {}, **given,
        )  # fmt: skip
        kept = folder and folder / f"{re.sub(r'[^a-z0-9.-]+', '-', name.lower())}.json"
        work[case, which, old, seed] = name, partial(_kept, call, kept)
    rows, starts = {(row.condition, row.terms) for row in ROWS}, effort.starts
    for case, terms in product(CONDITIONS, TERMS):
        for where, bound in (("in box", case.bound), ("no box", None)):
            if effort.full or (case, terms) in rows:
                profile = CycloidPolynomial(terms)
                solve = partial(plan_move, case.task, profile, bound=bound, starts=starts)
                work[where, case, terms] = f"gradient, {where}: {case.name}, N = {terms}", solve
    others = [(case, case.earlier[1]) for case in (CONDITIONS if effort.full else STUDIED)]
    compared = effort.systems if effort.full else ()
    for case, name in [*others, *product(compared, ["spline"])]:
        solve = partial(plan_move, case.task, OTHERS[name], starts=starts)
        work["other", case, name] = f"gradient: {case.name}, {name}", solve
    for case in CONDITIONS if effort.full else ():
        pieces = {
            "free motion": partial(energy_floor, case.task, **effort.free_motion),
            "both solvers": partial(_checked, case, effort.points),
            **({"robust": partial(_robust, case, starts)} if case in compared else {}),
        }
        work |= {(what, case): (f"{what}: {case.name}", call) for what, call in pieces.items()}
    return work


def _kept(call: Callable[[], Front], path: Path | None) -> Front:
    """A front that is kept already, if it is by the same versions, or found now and kept."""
    if path is not None and path.exists():
        front = Front.load(path)
        if front.record.versions.items() >= versions().items():
            return front
    front = call()
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        front.save(path)
    return front


def _checked(case: Case, points: int) -> CrossCheck:
    """Points of the front in the paper's box, by both solvers of the gradient."""
    profile = CycloidPolynomial(SIX_TERMS)
    return cross_check(epsilon_front(case.task, profile, bound=case.bound, points=points))


def _robust(case: Case, starts: int) -> Plan | str:
    """Within 5 % of the plain cycloid's residual whatever the frequency; or why that cannot be."""
    task = replace(case.task, uncertainty=Uncertainty(FREQUENCY_ERROR))
    limit = tolerated_residual(case.task)
    try:
        return plan_move(task, CycloidPolynomial(SIX_TERMS), residual_limit=limit, starts=starts)
    except SolverFailedError as none:
        return str(none)
