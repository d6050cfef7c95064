"""Recompute the paper: every row of its Tables 2, 3, 5 and 6, and what it claims."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

from metaheuristics import search
from metaheuristics.ensemble import Spread, energies_at
from ocp import (
    CycloidPolynomial,
    Floor,
    Front,
    Plan,
    energy_floor,
    evaluate_coefficients,
    plan_move,
)
from studies.paper.printed import (
    ARM_HALF,
    COEFFICIENTS,
    MENDED,
    ROWS,
    SINGLE_LINK_SIXTH,
    Condition,
    Row,
)

BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
PAPER_METHOD = {SINGLE_LINK_SIXTH.plant.name: "vepso", ARM_HALF.plant.name: "nsga2"}
"""The paper's search for each plant: sections 3.1 and 3.2."""
METHODS = ("vepso", "nsga2")
TERMS = (2, 4, 6, *BEYOND_SIX)
"""Numbers of terms that the gradient solves every condition for."""
CONDITIONS = tuple(dict.fromkeys(row.condition for row in ROWS))
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""


@dataclass(frozen=True)
class RowResult:
    """A row of the paper beside what is computed here.

    Attributes
    ----------
    row : Row
        What is printed.
    printed : Plan or None
        The printed coefficients evaluated, where the paper prints any for this condition.
    mended : Plan or None
        The same with a misprint mended, where there is one.
    in_box, free : Plan
        The gradient answer at rest on arrival, in the paper's box and without one.
    fronts : tuple of Front
        The paper's own search with its settings, a front a seed: VEPSO for the single link,
        NSGA-II for the arm.
    other_fronts : tuple of Front
        The same by the other one of the two.
    residual_level : float
        Residual [m] of the paper's coefficients, or where it prints none, of its N = 6 row for the
        same plant (with the misprint mended).
    """

    row: Row
    printed: Plan | None
    mended: Plan | None
    in_box: Plan
    free: Plan
    fronts: tuple[Front, ...]
    other_fronts: tuple[Front, ...]
    residual_level: float

    @property
    def searched(self) -> Spread:
        """Quartiles over the seeds of the least energy [J] at the residual level."""
        return energies_at(self.fronts, self.residual_level)

    def searched_by(self, method: str) -> Spread:
        """The same for a method by its name."""
        own = method == PAPER_METHOD[self.row.condition.plant.name]
        return energies_at(self.fronts if own else self.other_fronts, self.residual_level)

    @property
    def search_seconds(self) -> float:
        """Median time of a search [s]."""
        return Spread.of([front.seconds for front in self.fronts]).median


@dataclass(frozen=True)
class Reproduction:
    """All that `reproduce` computes.

    Attributes
    ----------
    rows : tuple of RowResult
        One for every row of Tables 2, 3, 5 and 6.
    cycloids : dict
        The plain cycloid of each studied condition.
    more_terms : dict
        Gradient answers by (condition, terms, whether in the box).
    floors : dict
        The least energy over all joint motions, at rest on arrival, of each condition.
    """

    rows: tuple[RowResult, ...]
    cycloids: dict[Condition, Plan]
    more_terms: dict[tuple[Condition, int, bool], Plan]
    floors: dict[Condition, Floor]

    def row(self, table: int, condition: Condition, terms: int) -> RowResult:
        """The result for one row of a table."""
        for result in self.rows:
            row = result.row
            if (row.table, row.condition, row.terms) == (table, condition, terms):
                return result
        raise KeyError((table, condition, terms))


def solve_keys() -> list[tuple[Condition, int, bool]]:
    """What the gradient has to solve, each once: (condition, terms, whether in the box)."""
    return [(c, terms, boxed) for c in CONDITIONS for terms in TERMS for boxed in (True, False)]


def search_keys() -> list[tuple[Condition, int]]:
    """What the metaheuristics have to search, each once: (condition, terms)."""
    return list(dict.fromkeys((row.condition, row.terms) for row in ROWS))


def amount_of_work(seeds: int) -> int:
    """How many solves, floors and searches `reproduce` begins."""
    return len(solve_keys()) + len(CONDITIONS) + seeds * len(METHODS) * len(search_keys())


def reproduce(begin: Callable[[str], None] = lambda name: None, seeds: int = 1) -> Reproduction:
    """Recompute the paper's tables with gradient, metaheuristics and floor beside them.

    Parameters
    ----------
    begin : callable, optional
        Called with the name of every solve, floor and search when it begins; `amount_of_work` says
        how many there are.
    seeds : int
        Seeds of the metaheuristics.

    Returns
    -------
    Reproduction
        Plans and fronts for every row; plans are verified by the independent integrator.

    Raises
    ------
    ValueError
        When `seeds` is below 1.
    KeyboardInterrupt
        When a search was interrupted.
    """
    if seeds < 1:
        raise ValueError(f"seeds is {seeds}; give 1 or more")
    solved = _solve(begin)
    floors = _floors(begin)
    fronts = _search(begin, seeds)
    rows: list[RowResult] = []
    for row in ROWS:
        key = (row.condition, row.terms)
        own = PAPER_METHOD[row.condition.plant.name]
        (other,) = (method for method in METHODS if method != own)
        rows.append(
            RowResult(
                row,
                printed=_evaluated(COEFFICIENTS, *key),
                mended=_evaluated(MENDED, *key),
                in_box=solved[*key, True],
                free=solved[*key, False],
                fronts=fronts[own, *key],
                other_fronts=fronts[other, *key],
                residual_level=_residual_level(*key),
            )
        )
    return Reproduction(
        tuple(rows),
        cycloids={c: evaluate_coefficients(c.task, []) for c in STUDIED},
        more_terms=solved,
        floors=floors,
    )


def _solve(begin: Callable[[str], None]) -> dict[tuple[Condition, int, bool], Plan]:
    solved: dict[tuple[Condition, int, bool], Plan] = {}
    for condition, terms, boxed in solve_keys():
        begin(f"gradient: {_label(condition, terms)}{', in the box' * boxed}")
        bound = condition.box if boxed else None
        solved[condition, terms, boxed] = plan_move(
            condition.task, CycloidPolynomial(terms), bound=bound
        )
    return solved


def _floors(begin: Callable[[str], None]) -> dict[Condition, Floor]:
    floors: dict[Condition, Floor] = {}
    for condition in CONDITIONS:
        begin(f"floor: {condition.plant.name}, {condition.label}")
        floors[condition] = energy_floor(condition.task)
    return floors


def _search(
    begin: Callable[[str], None], seeds: int
) -> dict[tuple[str, Condition, int], tuple[Front, ...]]:
    found: dict[tuple[str, Condition, int], tuple[Front, ...]] = {}
    for method, (condition, terms) in product(METHODS, search_keys()):
        fronts: list[Front] = []
        for seed in range(seeds):
            begin(f"{method}: {_label(condition, terms)}, seed {seed}")
            profile = CycloidPolynomial(terms)
            front = search(condition.task, method, profile=profile, bound=condition.box, seed=seed)
            if not front.complete:
                raise KeyboardInterrupt
            fronts.append(front)
        found[method, condition, terms] = tuple(fronts)
    return found


def _label(condition: Condition, terms: int) -> str:
    return f"{condition.plant.name}, {condition.label}, N = {terms}"


def _evaluated(
    table: dict[tuple[Condition, int], tuple[float, ...]], condition: Condition, terms: int
) -> Plan | None:
    coefficients = table.get((condition, terms))
    return None if coefficients is None else evaluate_coefficients(condition.task, coefficients)


def _residual_level(condition: Condition, terms: int) -> float:
    key = (condition, terms)
    if key not in COEFFICIENTS:
        key = next(k for k in COEFFICIENTS if k[0].plant == condition.plant and k[1] == terms)
    coefficients = MENDED.get(key, COEFFICIENTS[key])
    return evaluate_coefficients(key[0].task, coefficients).residual
