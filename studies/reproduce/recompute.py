"""The paper as jobs: its searches, and what the gradient finds for the same moves."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import product
from pathlib import Path
from typing import Any

from quietarm.metaheuristics import search
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
    task_difference,
)
from quietarm.ocp.record import versions
from quietarm.ocp.robustness.measures import tolerated_residual
from quietarm.studies.compare.judged import Judged, judge
from quietarm.studies.compare.plans import compare_plans
from quietarm.studies.reproduce.paper import COEFFICIENTS, CONDITIONS, ROWS, STUDIED, Case
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
VEPSO_2002 = {
    "inertia": 1.0, "last_inertia": 0.4, "constriction": 1.0, "cognitive": 0.5, "social": 0.5
}  # fmt: skip
"""Constants of Parsopoulos and Vrahatis; the paper names none."""
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
    starts, other_starts : int
        Of the gradient, for polynomials and for other inputs.
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
    other_starts: int = 4
    points: int = 50
    free_motion: Mapping[str, Any] = field(default_factory=dict)
    systems: tuple[Case, ...] = CONDITIONS

    @property
    def searched(self) -> list[tuple[Case, Input, bool]]:
        """What is searched: the case, the input, and whether by the constants of 2002."""
        rows = dict.fromkeys((row.condition, row.terms) for row in ROWS)
        chosen: list[tuple[Case, Input]] = list(rows)
        if self.full:
            chosen += [(case, case.earlier[1]) for case in CONDITIONS]
            chosen += product(STUDIED, BEYOND_SIX)
        return [*((case, which, False) for case, which in chosen),
                *([(CONDITIONS[0], SIX_TERMS, True)] * self.full)]  # fmt: skip


@dataclass(frozen=True)
class Reproduction:
    """All that `recompute_paper` computes."""

    effort: Effort
    searched: Mapping[tuple[Case, Input], Searched]
    by_constants_of_2002: Searched | None
    answers: Mapping[Hashable, Any]
    systems: Mapping[Case, list[Judged]]

    def printed(self, case: Case, terms: int) -> Plan | None:
        """The printed coefficients evaluated, misprints and all; None where none are printed."""
        return _evaluated(case, COEFFICIENTS.get((case, terms)))

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

    @property
    def checks(self) -> dict[Case, CrossCheck]:
        """Fronts by both solvers."""
        return {case: self.answers["both solvers", case] for case in CONDITIONS}


@cache
def _evaluated(case: Case, coefficients: tuple[float, ...] | None) -> Plan | None:
    return None if coefficients is None else evaluate_coefficients(case.task, coefficients)


def recompute_paper(
    effort: Effort | None = None,
    workers: int = 1,
    begin: Callable[[str], object] = lambda name: None,
    folder: Path | None = None,
) -> Reproduction:
    """Recompute the paper's tables and figures; with full effort what its claims need, too.

    Parameters
    ----------
    effort : Effort, optional
        How thoroughly; by default the tables and figures, with one seed.
    workers : int
        Processes that share the work.
    begin : callable, optional
        Is told what is done, piece by piece; there are `number_of_pieces`.
    folder : path, optional
        Where the fronts of the searches are kept, each as soon as it is done. Those that are there
        are not searched again.
    """
    effort = Effort() if effort is None else effort
    fronts = _in_parallel(_searches(effort, folder), workers, begin)
    answers = _in_parallel(_solves(effort), workers, begin)
    found = {
        of: Searched(*of[:2], tuple(fronts[*of, seed] for seed in range(effort.seeds)))
        for of in effort.searched
    }
    searched = {of[:2]: one for of, one in found.items() if not of[2]}
    part = Reproduction(
        effort, searched, next((one for of, one in found.items() if of[2]), None), answers, {}
    )
    if not effort.full:
        return part
    return replace(part, systems={case: _systems(part, case, begin) for case in effort.systems})


def number_of_pieces(effort: Effort) -> int:
    """How many pieces of work there are."""
    return len(_searches(effort, None)) + len(_solves(effort)) + len(effort.systems) * effort.full


_Calls = dict[Hashable, tuple[str, Callable[[], Any]]]


def _searches(effort: Effort, folder: Path | None) -> dict[Any, tuple[str, Callable[[], Front]]]:
    """Every search; the long ones first, so that in the end no worker waits long for another."""
    calls: dict[Any, tuple[str, Callable[[], Front]]] = {}
    ordered = sorted(effort.searched, key=lambda of: of[0].search)
    for (case, which, old), seed in product(ordered, range(effort.seeds)):
        words = f"N = {which}" if isinstance(which, int) else which
        own = f"{case.search}{' with the constants of 2002' * old}"
        name = f"{own}: {case.name}, {words}, seed {seed}"
        asked = {
            "profile": profile_with(which), "seed": seed,
            "bound": case.bound if isinstance(which, int) else None,  # others have their own
            "settings": VEPSO_2002 if old else {}, **effort.searches.get(case.search, {}),
        }  # fmt: skip
        kept = folder and folder / f"{re.sub(r'[^a-z0-9.-]+', '-', name.lower())}.json"
        calls[case, which, old, seed] = name, partial(_search, case, asked, kept)
    return calls


def _search(case: Case, asked: Mapping[str, Any], kept: Path | None) -> Front:
    """A front that is kept already, if it is of the same search, or found now and kept."""
    if kept is not None and kept.exists():
        front = Front.load(kept)
        sizes = {name: asked[name] for name in ("population", "generations") if name in asked}
        same = (
            not task_difference(front.task, case.task),
            (front.profile, front.seed) == (asked["profile"], asked["seed"]),
            front.settings.items() >= {**asked["settings"], **sizes}.items(),
            front.versions.items() >= versions().items(),
        )
        if all(same):
            return front
    front = search(case.task, case.search, **asked)
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        front.save(kept)
    return front


def _solves(effort: Effort) -> _Calls:
    """Everything by gradient."""
    calls: _Calls = {}
    rows = {(row.condition, row.terms) for row in ROWS}
    for case, terms in product(CONDITIONS, TERMS):
        if not effort.full and (case, terms) not in rows:
            continue
        profile = CycloidPolynomial(terms)
        for where, bound in (("in box", case.bound), ("no box", None)):
            solve = partial(plan_move, case.task, profile, bound=bound, starts=effort.starts)
            calls[where, case, terms] = f"gradient, {where}: {case.name}, N = {terms}", solve
    others = [(case, case.earlier[1]) for case in (CONDITIONS if effort.full else STUDIED)]
    compared = effort.systems if effort.full else ()
    others += product(compared, ["spline"])
    for case, name in others:
        solve = partial(plan_move, case.task, OTHERS[name], starts=effort.other_starts)
        calls["other", case, name] = f"gradient: {case.name}, {name}", solve
    for case in CONDITIONS if effort.full else ():
        calls["free motion", case] = (
            f"free motion: {case.name}", partial(energy_floor, case.task, **effort.free_motion)
        )  # fmt: skip
        calls["both solvers", case] = (
            f"both solvers: {case.name}", partial(_checked, case, effort.points)
        )  # fmt: skip
    for case in compared:
        calls["robust", case] = f"robust: {case.name}", partial(_robust, case, effort.starts)
    return calls


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


def _systems(found: Reproduction, case: Case, begin: Callable[[str], object]) -> list[Judged]:
    """Every system on one move, each judged alike."""
    begin(f"side by side: {case.name}")
    printed = next(row for row in ROWS if row.condition == case and row.terms == SIX_TERMS)
    plan, robust = found.printed(case, SIX_TERMS), found.answers["robust", case]
    middle = found.searched[case, SIX_TERMS].middle
    moved: dict[str, Plan | Floor | str] = {
        "paper": plan or f"prints {printed.energy:.4g} J, and no coefficients",
        **{name: found.answers["other", case, name] for name in (case.earlier[1], "spline")},
        case.search_label: middle or "the middle seed has no such small residual",
        "gradient, in the box": found.in_box(case, SIX_TERMS),
        "gradient": found.free(case, SIX_TERMS),
        "robust plan": robust,
        "free motion": found.floor(case),
    }
    return [
        *compare_plans({}, _SHAPERS, FREQUENCY_ERROR, 0, task=case.task),
        *(
            Judged(name, why=one) if isinstance(one, str)
            else judge(name, one, FREQUENCY_ERROR, case.task)
            for name, one in moved.items()
        ),
    ]  # fmt: skip


def _in_parallel(
    calls: Mapping[Any, tuple[str, Callable[[], Any]]],
    workers: int,
    begin: Callable[[str], object],
) -> dict[Any, Any]:
    """What calls give, by their keys."""
    keys, found = list(calls), dict[Any, Any]()
    work = [(i, call) for i, (_, call) in enumerate(calls.values())]
    for i, answer in side_by_side(_numbered, work, workers):
        found[keys[i]] = answer
        begin(calls[keys[i]][0])
    return found


def _numbered(work: tuple[int, Callable[[], Any]]) -> tuple[int, Any]:
    number, call = work
    return number, call()
