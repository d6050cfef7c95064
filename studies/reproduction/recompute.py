"""Recompute the paper: every row of its Tables 2, 3, 5 and 6, and what it claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product

from metaheuristics.ensemble import Spread, energies_at, number_of_runs, one_seed
from metaheuristics.sharing.pieces import Done, InterruptedPiece, Listener, Piece, Say, to_the_end
from metaheuristics.sharing.running import run_pieces
from ocp import (
    CycloidPolynomial,
    Floor,
    Front,
    Plan,
    energy_floor,
    evaluate_coefficients,
    plan_move,
)
from ocp.base.interrupts import note_interrupts
from studies.methods import Method
from studies.paper.case import Case
from studies.paper.printed import (
    ARM_HALF,
    COEFFICIENTS,
    CONDITIONS,
    EARLIER,
    MENDED,
    PAPER_SEARCH,
    ROWS,
    SINGLE_LINK_SIXTH,
    Row,
)

BEYOND_SIX = (8, 10)
"""Numbers of terms that check the paper's 'no gain above six'."""
SEARCHES = tuple(PAPER_SEARCH.values())
"""The paper's two searches, in its order."""
TERMS = (2, 4, 6, *BEYOND_SIX)
"""Numbers of terms that the gradient solves every condition for."""
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""
SOLVES = tuple(product(CONDITIONS, TERMS, (True, False)))
"""What the gradient solves: condition, number of terms, whether in the paper's box."""


COMPARED = tuple(row.condition for row in ROWS if row.earlier_energy is not None)
"""The conditions at which the paper compares itself with an earlier study: its Tables 3 and 6."""
EARLIER_STUDY = "earlier study"
EARLIER_STARTS = 3
"""Starts of the solver for the earlier studies' profiles, which have several minima."""


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
    earlier : Plan or None
        The gradient answer at rest on arrival with the earlier study's profile, as this project
        reads it, where the paper compares with that study.
    fronts : dict of Method to tuple of Front
        What VEPSO and NSGA-II find with the paper's settings, one front for each seed.
    residual_level : float
        Residual [m] of the paper's coefficients, or where it prints none, of its N = 6 row for the
        same plant (with the misprint mended).
    """

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

    @property
    def search_seconds(self) -> float:
        """Median time of the paper's own search [s]."""
        return Spread.of([front.seconds for front in self.fronts[self.own_search]]).median


@dataclass(frozen=True)
class Reproduction:
    """All that `recompute_paper` computes.

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
    cycloids: dict[Case, Plan]
    more_terms: dict[tuple[Case, int, bool], Plan]
    floors: dict[Case, Floor]

    def result(self, condition: Case, terms: int) -> RowResult:
        """The result of the first row for a condition and number of terms; KeyError if none."""
        for result in self.rows:
            if (result.row.condition, result.row.terms) == (condition, terms):
                return result
        raise KeyError((condition, terms))


def pieces_of_paper(seeds: int) -> list[Piece]:
    """Every solve, floor and search, each once; the keys are those of `Reproduction`.

    Parameters
    ----------
    seeds : int
        Seeds of the metaheuristics.

    Returns
    -------
    list of Piece
        Solves under (condition, terms, whether in the box), those with the earlier study's profile
        under (condition, `EARLIER_STUDY`), floors under their condition, and searches under
        (method, condition, terms, seed).

    Raises
    ------
    ValueError
        When `seeds` is out of range.
    """
    seeds = number_of_runs(seeds, "seeds")
    work: list[Piece] = []
    for condition, terms, boxed in SOLVES:
        name = f"gradient: {_label(condition, terms)}{', in the box' * boxed}"
        solve = partial(_solved, condition, terms, boxed)
        work.append(Piece((condition, terms, boxed), name, solve))
    for condition in COMPARED:
        reference, profile_name, _ = EARLIER[condition.task.plant.name]
        name = f"{EARLIER_STUDY}: {condition.task.plant.name}, {condition.label}, {profile_name}"
        solve = partial(_solved_as_earlier, condition)
        work.append(Piece((condition, EARLIER_STUDY), f"{name} of ref. [{reference}]", solve))
    for condition in CONDITIONS:
        name = f"floor: {condition.task.plant.name}, {condition.label}"
        work.append(Piece(condition, name, partial(_floor, condition)))
    for method in SEARCHES:
        for condition, terms in dict.fromkeys((row.condition, row.terms) for row in ROWS):
            for seed in range(seeds):
                name = f"{method.name}: {_label(condition, terms)}, seed {seed}"
                settings = {"profile": CycloidPolynomial(terms), "bound": condition.bound}
                search = partial(one_seed, condition.task, method.name, settings, seed)
                work.append(Piece((method, condition, terms, seed), name, search))
    return work


def recompute_paper(
    begin: Callable[[str], None] = lambda name: None, seeds: int = 1
) -> Reproduction:
    """Recompute the paper's tables with gradient, metaheuristics and floor beside them.

    Parameters
    ----------
    begin : callable, optional
        Called with the name of every solve, floor and search when it begins; `pieces_of_paper`
        lists them.
    seeds : int
        Seeds of the metaheuristics.

    Returns
    -------
    Reproduction
        Plans and fronts for every row; plans are verified by the independent integrator.

    Raises
    ------
    ValueError
        When `seeds` is out of range.
    InterruptedPiece
        When it was interrupted; its part is a `Done`.
    """
    done = run_pieces(pieces_of_paper(seeds), Listener(begin))
    if done.stopped:
        raise InterruptedPiece(done)
    with note_interrupts():  # nothing is left to be stopped
        return Reproduction(
            tuple(_row_result(row, done, seeds) for row in ROWS),
            cycloids={c: evaluate_coefficients(c.task, []) for c in STUDIED},
            more_terms={solve: done.answers[solve] for solve in SOLVES},
            floors={c: done.answers[c] for c in CONDITIONS},
        )


def _row_result(row: Row, done: Done, seeds: int) -> RowResult:
    key = (row.condition, row.terms)
    return RowResult(
        row,
        printed=_evaluated(COEFFICIENTS, *key),
        mended=_evaluated(MENDED, *key),
        in_box=done.answers[*key, True],
        free=done.answers[*key, False],
        earlier=(
            None if row.earlier_energy is None else done.answers[row.condition, EARLIER_STUDY]
        ),
        fronts={
            method: tuple(done.answers[method, *key, seed] for seed in range(seeds))
            for method in SEARCHES
        },
        residual_level=_residual_level(*key),
    )


def _solved(condition: Case, terms: int, boxed: bool, earlier: Done, say: Say) -> Plan:
    bound = condition.bound if boxed else None
    return to_the_end(plan_move(condition.task, CycloidPolynomial(terms), bound=bound))


def _solved_as_earlier(condition: Case, earlier: Done, say: Say) -> Plan:
    _, _, profile = EARLIER[condition.task.plant.name]
    return to_the_end(plan_move(condition.task, profile, starts=EARLIER_STARTS))


def _floor(condition: Case, earlier: Done, say: Say) -> Floor:
    return to_the_end(energy_floor(condition.task))


def _label(condition: Case, terms: int) -> str:
    return f"{condition.task.plant.name}, {condition.label}, N = {terms}"


def _evaluated(
    table: dict[tuple[Case, int], tuple[float, ...]], condition: Case, terms: int
) -> Plan | None:
    coefficients = table.get((condition, terms))
    return None if coefficients is None else evaluate_coefficients(condition.task, coefficients)


def _residual_level(condition: Case, terms: int) -> float:
    key = (condition, terms)
    if key not in COEFFICIENTS:
        key = next(
            k for k in COEFFICIENTS if k[0].task.plant == condition.task.plant and k[1] == terms
        )
    coefficients = MENDED.get(key, COEFFICIENTS[key])
    return evaluate_coefficients(key[0].task, coefficients).residual
