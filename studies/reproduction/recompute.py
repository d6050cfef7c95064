"""Recompute the paper: every row of its Tables 2, 3, 5 and 6, every system, what it claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

from quietarm.metaheuristics.ensemble import number_of_runs, one_seed
from quietarm.metaheuristics.sharing.pieces import (
    Done,
    InterruptedPiece,
    Listener,
    Piece,
    Say,
)
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.ocp import (
    CrossCheck,
    CycloidPolynomial,
    Floor,
    JointProfile,
    Plan,
    SolverFailedError,
    Uncertainty,
    cross_check,
    energy_floor,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.robustness.measures import tolerated_residual
from quietarm.ocp.uncertainty import FREQUENCY
from quietarm.studies.paper import (
    COEFFICIENTS,
    CONDITIONS,
    DUAL_LINK_HALF,
    MENDED,
    ROWS,
    Case,
    Row,
)
from quietarm.studies.registry.methods import Method
from quietarm.studies.registry.profiles import OTHERS
from quietarm.studies.reproduction.searches import (
    BEYOND_SIX,
    COMPARED_TERMS,
    LIKE_FOR_LIKE,
    SEARCHES,
    STUDIED,
    Experiment,
    Searched,
    earlier_input,
    input_name,
    profile_with,
)
from quietarm.studies.reproduction.systems import FREQUENCY_ERROR, ROBUST, System, systems_of

CASES = (*CONDITIONS, DUAL_LINK_HALF)
"""The moves on which all systems stand side by side."""
TERMS = (2, 4, 6, *BEYOND_SIX)
"""Numbers of terms that the gradient solves every condition of the paper for."""
PAPER_SOLVES = tuple(product(CONDITIONS, TERMS, (True, False)))
"""What the gradient solves for the paper: condition, terms, whether in the paper's box."""
STARTS = {"network": 4, "Gaussians": 4, "spline": 2}
"""Starts of the solver for profiles other than the polynomial; docs/physics.md, 'Other inputs of
the cycloid', says how many of them end at the best."""
SYSTEMS, CHECKED = "side by side", "by both solvers"

_SOLVES = (*PAPER_SOLVES, *product([DUAL_LINK_HALF], [COMPARED_TERMS], (True, False)))
_MOVES = [*((row.condition, row.terms) for row in ROWS), (DUAL_LINK_HALF, COMPARED_TERMS)]
_SEARCHED = dict.fromkeys(
    # long ones first, so that in the end no worker waits long for another
    sorted(
        [*((m, case, n) for m, (case, n) in product(SEARCHES, _MOVES)), *LIKE_FOR_LIKE],
        key=lambda of: -SEARCHES.index(of[0]),
    )
)
"""What is searched: by which method, which move, with which input."""


def pieces_of_paper(seeds: int) -> list[Piece]:
    """Every solve, floor and search, each once; the keys are those of `Reproduction`."""
    seeds = number_of_runs(seeds, "seeds")
    pieces: list[Piece] = []
    for case, terms, boxed in _SOLVES:
        settings = {"bound": case.bound if boxed else None}
        name = f"gradient: {case.name}, N = {terms}{', in the box' * boxed}"
        work = partial(_solved, case, CycloidPolynomial(terms), settings)
        pieces.append(Piece((case, terms, boxed), name, work))
    for (method, case, which), seed in product(_SEARCHED, range(seeds)):
        bound = None if isinstance(which, str) else case.bound  # other inputs have their own
        settings = {"profile": profile_with(which), "bound": bound}
        name = f"{method.name}: {case.name}, {input_name(which)}, seed {seed}"
        work = partial(one_seed, case.task, method.name, settings, seed)
        pieces.append(Piece((method, case, which, seed), name, work))
    pieces += [Piece(c, f"floor: {c.name}", partial(_floor, c)) for c in reversed(CASES)]
    pieces += [
        Piece((c, ROBUST), f"gradient: {c.name}, robust", partial(_solved_robustly, c))
        for c in reversed(CASES)
    ]
    for profile, case in product(OTHERS, reversed(CASES)):
        work = partial(_solved, case, OTHERS[profile], {"starts": STARTS[profile]})
        pieces.append(Piece((case, profile), f"gradient: {case.name}, {profile}", work))
    pieces += [
        Piece((c, CHECKED), f"front, {CHECKED}: {c.name}", partial(_checked, c)) for c in CONDITIONS
    ]
    for case in CASES:
        needed = [(case, COMPARED_TERMS, True), (case, COMPARED_TERMS, False), case]
        needed += [(case, name) for name in (*OTHERS, ROBUST)]
        needed += [(m, case, COMPARED_TERMS, s) for m, s in product(SEARCHES, range(seeds))]
        work = partial(_systems, case, seeds)
        pieces.append(Piece((case, SYSTEMS), f"{SYSTEMS}: {case.name}", work, tuple(needed)))
    return pieces


def _solved(
    case: Case, profile: JointProfile, settings: Mapping[str, Any], earlier: Done, say: Say
) -> Plan:
    return plan_move(case.task, profile, **settings)


def _solved_robustly(case: Case, earlier: Done, say: Say) -> Plan | str:
    """Within 5 % of the plain cycloid's residual whatever the frequency; or why that cannot be."""
    uncertainty = Uncertainty({FREQUENCY: FREQUENCY_ERROR})
    profile = CycloidPolynomial(COMPARED_TERMS)
    try:
        limit = tolerated_residual(case.task)
        task = replace(case.task, uncertainty=uncertainty)
        return plan_move(task, profile, residual_limit=limit)
    except SolverFailedError as none:
        return str(none)


def _checked(case: Case, earlier: Done, say: Say) -> CrossCheck:
    """Points of the exact front in the paper's box, by both solvers of the gradient."""
    profile = CycloidPolynomial(COMPARED_TERMS)
    return cross_check(epsilon_front(case.task, profile, bound=case.bound))


def _floor(case: Case, earlier: Done, say: Say) -> Floor:
    return energy_floor(case.task)


def _systems(case: Case, seeds: int, earlier: Done, say: Say) -> tuple[System, ...]:
    return systems_of(case, earlier.answers, seeds)


@dataclass(frozen=True)
class RowResult:
    """A row of the paper beside what is computed here."""

    row: Row
    printed: Plan | None
    mended: Plan | None
    in_box: Plan
    free: Plan
    earlier: Plan | None
    searched: Mapping[Method, Searched]

    @property
    def mended_or_printed(self) -> Plan | None:
        """The paper's coefficients, with a misprint mended; None where it prints none."""
        return self.mended or self.printed


@dataclass(frozen=True)
class Reproduction:
    """All that `recompute_paper` computes."""

    rows: tuple[RowResult, ...]
    cycloids: dict[Case, Plan]
    more_terms: dict[tuple[Case, int, bool], Plan]
    floors: dict[Case, Floor]
    systems: dict[Case, tuple[System, ...]]
    checks: dict[Case, CrossCheck]
    experiment: Experiment

    def result(self, condition: Case, terms: int) -> RowResult:
        """The first row of a condition and number of terms."""
        return next(r for r in self.rows if (r.row.condition, r.row.terms) == (condition, terms))


def recompute_paper(
    begin: Callable[[str], None] = lambda name: None, seeds: int = 1, workers: Workers = HERE
) -> Reproduction:
    """Recompute the paper's tables with gradient, metaheuristics and floor beside them."""
    done = run_pieces(pieces_of_paper(seeds), Listener(begin), workers=workers)
    if done.stopped:
        raise InterruptedPiece(done)
    with note_interrupts():  # nothing is left to be stopped
        return Reproduction(
            tuple(_row_result(row, done, seeds) for row in ROWS),
            cycloids={c: evaluate_coefficients(c.task, []) for c in STUDIED},
            more_terms={solve: done.answers[solve] for solve in PAPER_SOLVES},
            floors={c: done.answers[c] for c in CONDITIONS},
            systems={c: done.answers[c, SYSTEMS] for c in CASES},
            checks={c: done.answers[c, CHECKED] for c in CONDITIONS},
            experiment={
                (case, which): Searched.among(done.answers, method, case, which, seeds)
                for method, case, which in LIKE_FOR_LIKE
            },
        )


def _row_result(row: Row, done: Done, seeds: int) -> RowResult:
    key = case, terms = row.condition, row.terms
    printed, mended = (
        evaluate_coefficients(case.task, table[key]) if key in table else None
        for table in (COEFFICIENTS, MENDED)
    )
    return RowResult(
        row,
        printed,
        mended,
        in_box=done.answers[case, terms, True],
        free=done.answers[case, terms, False],
        earlier=None if row.earlier_energy is None else done.answers[case, earlier_input(case)],
        searched={
            method: Searched.among(done.answers, method, case, terms, seeds) for method in SEARCHES
        },
    )
