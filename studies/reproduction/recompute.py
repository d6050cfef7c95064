"""Recompute the paper: every row of its Tables 2, 3, 5 and 6, and what it claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from quietarm.metaheuristics.ensemble import Spread, energies_at
from quietarm.metaheuristics.sharing.pieces import Done, InterruptedPiece, Listener
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.ocp import CrossCheck, Floor, Front, Plan, evaluate_coefficients
from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.points import residual_level
from quietarm.studies.paper.printed import (
    COEFFICIENTS,
    CONDITIONS,
    EARLIER,
    MENDED,
    PAPER_SEARCH,
    ROWS,
    Row,
)
from quietarm.studies.registry.methods import Method
from quietarm.studies.reproduction.pieces import (
    CASES,
    CHECKED,
    PAPER_SOLVES,
    STUDIED,
    SYSTEMS,
    pieces_of_paper,
)
from quietarm.studies.reproduction.systems import SEARCHES, System


@dataclass(frozen=True)
class RowResult:
    """A row of the paper beside what is computed here."""

    row: Row
    printed: Plan | None
    mended: Plan | None
    in_box: Plan
    free: Plan
    earlier: Plan | None
    fronts: Mapping[Method, tuple[Front, ...]]
    residual_level: float

    @property
    def mended_or_printed(self) -> Plan | None:
        """The paper's coefficients, with a misprint mended; None where it prints none."""
        return self.mended or self.printed

    @property
    def own_search(self) -> Method:
        """The paper's own search for this plant."""
        return PAPER_SEARCH[self.row.condition.task.plant.name]

    def searched_by(self, method: Method) -> Spread:
        """Quartiles over the seeds of the least energy [J] at the residual level."""
        return energies_at(self.fronts[method], self.residual_level)


@dataclass(frozen=True)
class Reproduction:
    """All that `recompute_paper` computes."""

    rows: tuple[RowResult, ...]
    cycloids: dict[Case, Plan]
    more_terms: dict[tuple[Case, int, bool], Plan]
    floors: dict[Case, Floor]
    systems: dict[Case, tuple[System, ...]]
    checks: dict[Case, CrossCheck]

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
        )


def _row_result(row: Row, done: Done, seeds: int) -> RowResult:
    key = case, terms = row.condition, row.terms
    _, earlier = EARLIER[case.task.plant.name]
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
        earlier=None if row.earlier_energy is None else done.answers[case, earlier],
        fronts={
            method: tuple(done.answers[method, case, terms, seed] for seed in range(seeds))
            for method in SEARCHES
        },
        residual_level=residual_level(case, terms),
    )
