"""The paper as jobs: its searches, and what the gradient finds for the same moves."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple, dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

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
from quietarm.ocp.planning.named_profiles import OTHERS
from quietarm.ocp.record import versions
from quietarm.ocp.robustness import tolerated_residual
from quietarm.studies.compare.compared_motions import ComparedMotion, judge_motion
from quietarm.studies.compare.plan_comparison import compare_plans
from quietarm.studies.reproduce.paper import (
    CONDITIONS,
    ROWS,
    SIX,
    STUDIED,
    Case,
    paper_plan,
    residual_level,
)
from quietarm.studies.reproduce.searched import (
    OLD_CONSTANTS,
    SIX_TERMS,
    Input,
    Searched,
    profile_with,
)

BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
TERMS = (2, 4, SIX_TERMS, *BEYOND_SIX)
_CONSTANTS = ("inertia", "last_inertia", "constriction", "cognitive", "social")
VEPSO_2002: dict[str, object] = dict(zip(_CONSTANTS, astuple(INERTIA_2002)))
"""Settings with the constants of Parsopoulos and Vrahatis; the paper names none."""
FREQUENCY_ERROR = {"frequency": 0.1}


class Piece(NamedTuple):
    """A piece of work: what is done of a case, with which input, from which seed."""

    what: str
    case: Case
    which: Input | None = None
    seed: int | None = None

    @property
    def name(self) -> str:
        """All of it in a line."""
        which = f"N = {self.which}" if isinstance(self.which, int) else self.which
        seed = None if self.seed is None else f"seed = {self.seed}"
        return f"{self.what}: {', '.join(filter(None, [self.case.name, which, seed]))}"


Work = dict[Piece, Callable[[], Any]]


@dataclass(frozen=True)
class Effort:
    """The effort with which the paper is recomputed.

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
    def searched(self) -> list[tuple[Case, Input]]:
        """Conditions and inputs that are searched: those that take long first."""
        chosen: list[tuple[Case, Input]] = [(row.condition, row.terms) for row in ROWS]
        if self.full:
            chosen += [(case, case.earlier[1]) for case in CONDITIONS]
            chosen += [*product(STUDIED, BEYOND_SIX), (CONDITIONS[0], OLD_CONSTANTS)]
        return sorted(dict.fromkeys(chosen), key=lambda of: of[0].search)


@dataclass(frozen=True)
class Reproduction:
    """The paper as it was recomputed, with all that `recompute_paper` computes."""

    effort: Effort
    searched: Mapping[tuple[Case, Input], Searched]
    answers: Mapping[Piece, Any]

    def cycloid(self, case: Case) -> Plan:
        """The plain cycloid."""
        return evaluate_coefficients(case.task, [])

    def same_residual(self, case: Case, terms: int) -> Plan:
        """The gradient's plan within the paper's bounds, with the residual limit of the search."""
        return self.answers[Piece("gradient, same residual", case, terms)]

    def in_box(self, case: Case, terms: int) -> Plan:
        """The gradient's plan within the paper's bounds, at rest."""
        return self.answers[Piece("gradient, in box", case, terms)]

    def free(self, case: Case, terms: int) -> Plan:
        """The gradient's plan without bounds, at rest."""
        return self.answers[Piece("gradient, no box", case, terms)]

    def earlier(self, case: Case) -> Plan | None:
        """The gradient's plan with the earlier study's input; None where it was left out."""
        return self.answers.get(Piece("gradient", case, case.earlier[1]))

    def floor(self, case: Case) -> Floor:
        """The best motion found without a parametrisation."""
        return self.answers[Piece("free motion", case)]

    def check(self, case: Case) -> CrossCheck:
        """Return the front of a case by both solvers."""
        return self.answers[Piece("both solvers", case)]

    @cached_property
    def systems(self) -> dict[Case, list[ComparedMotion]]:
        """Every system on the same moves, each judged alike; none without full effort."""
        return {case: [*self._judged(case)] for case in self.effort.systems * self.effort.full}

    def _judged(self, case: Case) -> Iterator[ComparedMotion]:
        shapers = ("cycloid", "zv", "zvd", "ei")
        (printed,) = (row.energy for row in SIX if row.condition == case)
        moved: dict[str, Plan | Floor | str] = {
            "paper": paper_plan(case, SIX_TERMS, mended=False)
            or f"prints {printed:.4g} J, and no coefficients",
            **{
                name: self.answers[Piece("gradient", case, name)]
                for name in (case.earlier[1], "spline")
            },
            case.search_label: self.searched[case, SIX_TERMS].middle
            or "the middle seed has no such small residual",
            "gradient, within the bounds": self.in_box(case, SIX_TERMS),
            "gradient": self.free(case, SIX_TERMS),
            "robust plan": self.answers[Piece("robust", case)],
            "free motion": self.floor(case),
        }
        yield from compare_plans({}, shapers, FREQUENCY_ERROR, 0, task=case.task)
        for name, motion in moved.items():
            yield (
                ComparedMotion(name, why=motion)
                if isinstance(motion, str)
                else judge_motion(name, motion, FREQUENCY_ERROR, case.task)
            )


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
    effort = effort or Effort()
    answers = dict[Piece, Any]()
    for piece, answer in side_by_side(
        _done,
        list(_work(effort, folder).items()),
        workers,
    ):
        answers[piece] = answer
        report(piece.name)
    seeds = range(effort.seeds)
    searched = {
        (case, of): Searched(
            case, of, tuple(answers[Piece(case.search, case, of, k)] for k in seeds)
        )
        for case, of in effort.searched
    }
    return Reproduction(effort, searched, answers)


def number_of_pieces(effort: Effort) -> int:
    """Count the pieces of work."""
    return len(_work(effort, None))


def _done(item: tuple[Piece, Callable[[], Any]]) -> tuple[Piece, Any]:
    piece, call = item
    return piece, call()


def _work(effort: Effort, folder: Path | None) -> Work:
    """All work; the long searches first, so that in the end no worker waits long for another."""
    work: Work = {}
    for (case, which), seed in product(effort.searched, range(effort.seeds)):
        piece = Piece(case.search, case, which, seed)
        work[piece] = partial(
            _search,
            piece,
            effort.searches.get(piece.what, {}),
            folder,
        )
    rows = {(row.condition, row.terms) for row in ROWS}
    solve = partial(plan_move, starts=effort.starts)
    for case, terms in product(CONDITIONS, TERMS):
        if effort.full or (case, terms) in rows:
            free = partial(solve, case.task, CycloidPolynomial(terms))
            work[
                Piece(
                    "gradient, in box",
                    case,
                    terms,
                )
            ] = partial(free, bound=case.bound)
            work[Piece("gradient, same residual", case, terms)] = partial(
                free, bound=case.bound, residual_limit=residual_level(case, terms)
            )
            work[Piece("gradient, no box", case, terms)] = free
    compared = effort.systems * effort.full
    for case in CONDITIONS if effort.full else STUDIED:
        for name in (case.earlier[1], *["spline"] * (case in compared)):
            work[Piece("gradient", case, name)] = partial(
                solve,
                case.task,
                OTHERS[name],
            )
    for case in CONDITIONS * effort.full:
        work[Piece("free motion", case)] = partial(
            energy_floor,
            case.task,
            **effort.free_motion,
        )
        work[Piece("both solvers", case)] = partial(_checked, case, effort.points)
    for case in compared:
        work[Piece("robust", case)] = partial(_robust, case, effort.starts)
    return work


def _search(piece: Piece, settings: Mapping[str, Any], folder: Path | None) -> Front:
    """A front of the paper's search; one that is kept already, if it is by the same versions."""
    case = piece.case
    which = piece.which
    assert which is not None
    assert piece.seed is not None
    path = folder and folder / f"{re.sub(r'[^a-z0-9.-]+', '-', piece.name.lower())}.json"
    if path is not None and path.exists():
        front = Front.load(path)
        same = front.record.settings.items() >= settings.items()
        if same and front.record.versions.items() >= versions().items():
            return front
    front = search(
        case.task,
        profile_with(which),
        algorithm=piece.what,
        seed=piece.seed,
        bound=None if which in OTHERS else case.bound,  # others have their own
        settings=VEPSO_2002 if which == OLD_CONSTANTS else {},
        **settings,
    )
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        front.save(path)
    return front


def _checked(case: Case, points: int) -> CrossCheck:
    """Points of the front within the paper's bounds, by both solvers of the gradient."""
    profile = CycloidPolynomial(SIX_TERMS)
    return cross_check(
        epsilon_front(
            case.task,
            profile,
            bound=case.bound,
            points=points,
        )
    )


def _robust(case: Case, starts: int) -> Plan | str:
    """Plan within 5 % of the plain cycloid's residual at every frequency; or say why it fails."""
    task = replace(case.task, uncertainty=Uncertainty(FREQUENCY_ERROR))
    limit = tolerated_residual(case.task)
    try:
        return plan_move(
            task,
            CycloidPolynomial(SIX_TERMS),
            residual_limit=limit,
            starts=starts,
        )
    except SolverFailedError as none:
        return str(none)
