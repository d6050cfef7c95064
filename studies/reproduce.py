"""Recompute the paper: every row of its Tables 2, 3, 5 and 6, and what it claims."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ocp import CycloidPolynomial, Plan, evaluate_coefficients, plan_move
from studies.paper import (
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
    """

    row: Row
    printed: Plan | None
    mended: Plan | None
    in_box: Plan
    free: Plan


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
        Gradient answers by (condition, terms, whether in the box), for the studied conditions.
    """

    rows: tuple[RowResult, ...]
    cycloids: dict[Condition, Plan]
    more_terms: dict[tuple[Condition, int, bool], Plan]

    def row(self, table: int, condition: Condition, terms: int) -> RowResult:
        """The result for one row of a table."""
        for result in self.rows:
            row = result.row
            if (row.table, row.condition, row.terms) == (table, condition, terms):
                return result
        raise KeyError((table, condition, terms))


def solve_keys() -> list[tuple[Condition, int, bool]]:
    """What the gradient has to solve, each once: (condition, terms, whether in the box)."""
    cases = [(row.condition, row.terms) for row in ROWS]
    cases += [(condition, terms) for condition in STUDIED for terms in BEYOND_SIX]
    return [(*case, boxed) for case in dict.fromkeys(cases) for boxed in (True, False)]


def reproduce(begin: Callable[[str], None] = lambda name: None) -> Reproduction:
    """Recompute the paper's tables with the gradient answer beside them.

    Parameters
    ----------
    begin : callable, optional
        Called with the name of every solve when it begins; `solve_keys` says how many there are.

    Returns
    -------
    Reproduction
        Plans for every row, verified by the independent integrator.
    """
    solved: dict[tuple[Condition, int, bool], Plan] = {}
    for condition, terms, boxed in solve_keys():
        begin(f"{condition.plant.name}, {condition.label}, N = {terms}{', in the box' * boxed}")
        solved[condition, terms, boxed] = plan_move(
            condition.task,
            CycloidPolynomial(terms),
            bound=condition.box if boxed else None,
        )

    def evaluated(table: dict[tuple[Condition, int], tuple[float, ...]], row: Row) -> Plan | None:
        coefficients = table.get((row.condition, row.terms))
        if coefficients is None:
            return None
        return evaluate_coefficients(row.condition.task, coefficients)

    rows = tuple(
        RowResult(
            row,
            printed=evaluated(COEFFICIENTS, row),
            mended=evaluated(MENDED, row),
            in_box=solved[row.condition, row.terms, True],
            free=solved[row.condition, row.terms, False],
        )
        for row in ROWS
    )
    return Reproduction(
        rows,
        cycloids={c: evaluate_coefficients(c.task, []) for c in STUDIED},
        more_terms={key: plan for key, plan in solved.items() if key[0] in STUDIED},
    )
