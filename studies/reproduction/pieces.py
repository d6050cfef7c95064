"""The work of a reproduction, each solve, floor and search once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

from quietarm.metaheuristics.ensemble import number_of_runs, one_seed
from quietarm.metaheuristics.sharing.pieces import Done, Piece, Say, to_the_end
from quietarm.ocp import (
    CrossCheck,
    CycloidPolynomial,
    Floor,
    JointProfile,
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
    ROWS,
    SINGLE_LINK_SIXTH,
)
from quietarm.studies.registry.profiles import OTHERS
from quietarm.studies.reproduction.systems import (
    COMPARED_TERMS,
    FREQUENCY_ERROR,
    ROBUST,
    SEARCHES,
    System,
    systems_of,
)

CASES = (*CONDITIONS, DUAL_LINK_HALF)
"""The moves on which all systems stand side by side."""
BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
TERMS = (2, 4, 6, *BEYOND_SIX)
"""Numbers of terms that the gradient solves every condition of the paper for."""
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""
PAPER_SOLVES = tuple(product(CONDITIONS, TERMS, (True, False)))
"""What the gradient solves for the paper: condition, terms, whether in the paper's box."""
STARTS = {"network": 4, "Gaussians": 4, "spline": 2}
"""Starts of the solver for profiles other than the polynomial; docs/physics.md, 'Other inputs of
the cycloid', says how many of them end at the best."""
SYSTEMS, CHECKED = "side by side", "by both solvers"

_SOLVES = (*PAPER_SOLVES, *product([DUAL_LINK_HALF], [COMPARED_TERMS], (True, False)))
_SEARCHED = tuple(
    dict.fromkeys([*((r.condition, r.terms) for r in ROWS), (DUAL_LINK_HALF, COMPARED_TERMS)])
)


def pieces_of_paper(seeds: int) -> list[Piece]:
    """Every solve, floor and search, each once; the keys are those of `Reproduction`."""
    seeds = number_of_runs(seeds, "seeds")
    pieces: list[Piece] = []
    for case, terms, boxed in _SOLVES:
        settings = {"bound": case.bound if boxed else None}
        name = f"gradient: {case.name}, N = {terms}{', in the box' * boxed}"
        work = partial(_solved, case, CycloidPolynomial(terms), settings)
        pieces.append(Piece((case, terms, boxed), name, work))
    # long ones first, so that in the end no worker waits long for another
    for method, (case, terms), seed in product(reversed(SEARCHES), _SEARCHED, range(seeds)):
        settings = {"profile": CycloidPolynomial(terms), "bound": case.bound}
        name = f"{method.name}: {case.name}, N = {terms}, seed {seed}"
        work = partial(one_seed, case.task, method.name, settings, seed)
        pieces.append(Piece((method, case, terms, seed), name, work))
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
    return to_the_end(plan_move(case.task, profile, **settings))


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


def _systems(case: Case, seeds: int, earlier: Done, say: Say) -> tuple[System, ...]:
    return systems_of(case, earlier.answers, seeds)
