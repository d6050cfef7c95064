"""The work of a reproduction, each solve, floor and search once."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product

from quietarm.metaheuristics.ensemble import number_of_runs, one_seed
from quietarm.metaheuristics.sharing.pieces import Done, Piece, Say, to_the_end
from quietarm.ocp import (
    CrossCheck,
    CycloidPolynomial,
    Floor,
    Plan,
    SolverFailedError,
    UncertainPlant,
    cross_check,
    energy_floor,
    epsilon_front,
    plan_move,
)
from quietarm.ocp.robustness.measures import tolerated_residual
from quietarm.ocp.simulation.errors import FREQUENCY
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import (
    ARM_HALF,
    CONDITIONS,
    DUAL_LINK_HALF,
    PAPER_SEARCH,
    ROWS,
    SINGLE_LINK_SIXTH,
)
from quietarm.studies.registry.methods import Method
from quietarm.studies.registry.profiles import OTHERS
from quietarm.studies.reproduction.side_by_side.results import (
    COMPARED_TERMS,
    FREQUENCY_ERROR,
    ROBUST,
    Found,
    System,
    systems_of,
)

CASES = (*CONDITIONS, DUAL_LINK_HALF)
"""The moves on which all systems stand side by side."""
BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
SEARCHES = tuple(PAPER_SEARCH.values())
"""The paper's two searches, in its order."""
TERMS = (2, 4, 6, *BEYOND_SIX)
"""Numbers of terms that the gradient solves every condition of the paper for."""
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""
PAPER_SOLVES = tuple(product(CONDITIONS, TERMS, (True, False)))
"""What the gradient solves for the paper: condition, terms, whether in the paper's box."""
SOLVES = (*PAPER_SOLVES, *((DUAL_LINK_HALF, COMPARED_TERMS, boxed) for boxed in (True, False)))
"""The same with the third plant."""
SEARCHED = tuple(
    dict.fromkeys([*((r.condition, r.terms) for r in ROWS), (DUAL_LINK_HALF, COMPARED_TERMS)])
)
"""What is searched: move and terms."""
STARTS = {"network": 4, "Gaussians": 4, "spline": 2}
"""Starts of the solver for profiles other than the polynomial; docs/physics.md, 'Other inputs of
the cycloid', says how many of them end at the best."""
SYSTEMS, CHECKED = "side by side", "by both solvers"


def pieces_of_paper(seeds: int) -> list[Piece]:
    """Every solve, floor and search, each once; the keys are those of `Reproduction`."""
    seeds = number_of_runs(seeds, "seeds")
    work: list[Piece] = []
    for case, terms, boxed in SOLVES:
        name = f"gradient: {_label(case, terms)}{', in the box' * boxed}"
        work.append(Piece((case, terms, boxed), name, partial(_solved, case, terms, boxed)))
    # long ones first, so that in the end no worker waits long for another
    work += [
        piece
        for method in reversed(SEARCHES)
        for case, terms in SEARCHED
        for piece in _searches(method, case, terms, seeds)
    ]
    work += [Piece(case, f"floor: {case.name}", partial(_floor, case)) for case in reversed(CASES)]
    work += [
        Piece((case, ROBUST), f"gradient: {case.name}, robust", partial(_solved_robustly, case))
        for case in reversed(CASES)
    ]
    for profile, case in product(OTHERS, reversed(CASES)):
        name = f"gradient: {case.name}, {profile}"
        work.append(Piece((case, profile), name, partial(_solved_with, case, profile)))
    work += [
        Piece((case, CHECKED), f"front, {CHECKED}: {case.name}", partial(_checked, case))
        for case in CONDITIONS
    ]
    for case in CASES:
        name, needed = f"{SYSTEMS}: {case.name}", _needed(case, seeds)
        work.append(Piece((case, SYSTEMS), name, partial(_systems, case, seeds), tuple(needed)))
    return work


def _searches(method: Method, case: Case, terms: int, seeds: int) -> Iterator[Piece]:
    settings = {"profile": CycloidPolynomial(terms), "bound": case.bound}
    for seed, key in enumerate(searches_of(method, case, terms, seeds)):
        name = f"{method.name}: {_label(case, terms)}, seed {seed}"
        yield Piece(key, name, partial(one_seed, case.task, method.name, settings, seed))


def searches_of(method: Method, case: Case, terms: int, seeds: int) -> list[Hashable]:
    """The keys of a method's searches, one for each seed."""
    return [(method, case, terms, seed) for seed in range(seeds)]


def _solved(case: Case, terms: int, boxed: bool, earlier: Done, say: Say) -> Plan:
    bound = case.bound if boxed else None
    return to_the_end(plan_move(case.task, CycloidPolynomial(terms), bound=bound))


def _solved_with(case: Case, profile: str, earlier: Done, say: Say) -> Plan:
    return to_the_end(plan_move(case.task, OTHERS[profile], starts=STARTS[profile]))


def _solved_robustly(case: Case, earlier: Done, say: Say) -> Plan | str:
    """Within 5 % of the plain cycloid's residual whatever the frequency; or why that cannot be."""
    plant = UncertainPlant(case.task.plant, {FREQUENCY: FREQUENCY_ERROR})
    profile = CycloidPolynomial(COMPARED_TERMS)
    try:
        limit = tolerated_residual(case.task)
        task = replace(case.task, plant=plant)
        return to_the_end(plan_move(task, profile, residual_limit=limit))
    except SolverFailedError as none:
        return str(none)


def _checked(case: Case, earlier: Done, say: Say) -> CrossCheck:
    """Points of the exact front in the paper's box, by both solvers of the gradient."""
    profile = CycloidPolynomial(COMPARED_TERMS)
    return cross_check(to_the_end(epsilon_front(case.task, profile, bound=case.bound)))


def _floor(case: Case, earlier: Done, say: Say) -> Floor:
    return to_the_end(energy_floor(case.task))


def _needed(case: Case, seeds: int) -> list[Hashable]:
    solves = [(case, COMPARED_TERMS, boxed) for boxed in (True, False)]
    searches = [
        key for method in SEARCHES for key in searches_of(method, case, COMPARED_TERMS, seeds)
    ]
    return [*solves, *((case, profile) for profile in (*OTHERS, ROBUST)), *searches, case]


def _systems(case: Case, seeds: int, earlier: Done, say: Say) -> tuple[System, ...]:
    answers = earlier.answers
    found = Found(
        in_box=answers[case, COMPARED_TERMS, True],
        free=answers[case, COMPARED_TERMS, False],
        robust=answers[case, ROBUST],
        others={profile: answers[case, profile] for profile in OTHERS},
        fronts={
            method: [answers[key] for key in searches_of(method, case, COMPARED_TERMS, seeds)]
            for method in SEARCHES
        },
        floor=answers[case],
    )
    return systems_of(case, found)


def _label(case: Case, terms: int) -> str:
    return f"{case.name}, N = {terms}"
