"""Report of `quietarm reproduce`: the paper's tables and figures, systems, claims."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from statistics import median

import pandas as pd
from matplotlib.figure import Figure

from quietarm.ocp import Plan
from quietarm.ocp.window import EQ_11
from quietarm.studies.compare.plan_comparison import motions_table, remarks, shown
from quietarm.studies.reproduce.claims import Verdict, claims
from quietarm.studies.reproduce.paper import (
    ARM_HALF,
    MENDED,
    ROWS,
    SINGLE_LINK_SIXTH,
    Case,
    PaperRow,
    paper_plan,
)
from quietarm.studies.reproduce.recompute import FREQUENCY_ERROR, Reproduction
from quietarm.studies.reproduce.searched import SIX_TERMS, Input
from quietarm.views.pictures import PAPER_PANELS, RED, Line, motion_figure
from quietarm.views.pictures.grammar import PLAN, Look, variants
from quietarm.views.report import Report
from quietarm.views.report.report import percents
from quietarm.views.report.words import spread_words, title_of

TITLES = {
    2: "Table 2: number of terms, single link",
    3: "Table 3: against ref. [23], single link",
    5: "Table 5: number of terms, arm on a flexible link",
    6: "Table 6: against ref. [24], arm on a flexible link",
}


def paper_table(result: Reproduction, number: int) -> pd.DataFrame:
    """One of the paper's tables, the recomputed figures beside the printed ones."""
    rows = [_row(result, row) for row in ROWS if row.table == number]
    return pd.DataFrame(rows).dropna(axis=1, how="all")


def _row(result: Reproduction, row: PaperRow) -> dict[str, object]:
    """Names and figures of a row; energies [J], residuals [mm]."""
    case = row.condition
    terms = row.terms
    full = result.effort.full
    reference, name = case.earlier
    searched = result.searched[case, terms]
    printed = paper_plan(case, terms, mended=False)
    mended = paper_plan(case, terms) if (case, terms) in MENDED else None
    figures: dict[str, object] = {
        "condition": case.name,
        "terms N": terms,
        "paper, printed [J]": row.energy,
        "printed coefficients [J]": printed and printed.energy,
        "  residual [mm]": printed and 1e3 * printed.residual,
        "a_5 mended [J]": mended and mended.energy,
        "  residual of it [mm]": mended and 1e3 * mended.residual,
        "search": case.search_label,
        "  searched [J]": spread_words(searched.energies, ".4g"),
        "  within [mm]": 1e3 * searched.level,
        "  gradient within the same [J]": result.same_residual(case, terms).energy,
        "  time of a run [s]": median(searched.seconds),
        "gradient at rest, in the box [J]": result.in_box(case, terms).energy,
        "gradient at rest, no box [J]": result.free(case, terms).energy,
    }
    if row.earlier_energy is not None:
        before = result.searched.get((case, name))
        earlier = result.earlier(case)
        figures |= {
            "earlier study": f"{name}, ref. [{reference}]",
            "  printed there [J]": row.earlier_energy,
            "  its input, searched [J]": before and spread_words(before.energies, ".4g"),
            "  its input, gradient [J]": earlier and earlier.energy,
            "any motion at rest [J]": result.floor(case).energy if full else None,
            "both solvers differ by": result.check(case).largest if full else None,
        }
    return figures


def reproduction_report(result: Reproduction) -> Report:
    """The paper's tables and figures; of full effort the six conditions, systems and claims."""
    # the paper's figures: their condition, and whether they show the earlier study's input
    pictures = {
        "2": (SINGLE_LINK_SIXTH, False),
        "3": (SINGLE_LINK_SIXTH, True),
        "5": (ARM_HALF, False),
        "6": (ARM_HALF, True),
    }
    tables = {f"table_{number}": paper_table(result, number) for number in TITLES}
    judged = claims(result) if result.effort.full else []
    systems = {case.name: motions_table(motions) for case, motions in result.systems.items()}
    if result.effort.full:
        tables["six"] = pd.concat([tables["table_3"], tables["table_6"]])
        tables["claims"] = pd.concat(
            entry.evidence.assign(claim=entry.claim, verdict=entry.word) for entry in judged
        )
        tables["systems"] = pd.concat(
            entry.assign(condition=name) for name, entry in systems.items()
        )
    figures = {
        f"figure_{number}.png": partial(_redrawn, result, f"Fig. {number}", *shows)
        for number, shows in pictures.items()
    }
    values = {
        "titles": TITLES,
        "seeds": result.effort.seeds,
        "full": result.effort.full,
        "claims": judged,
        "error": f"{100 * FREQUENCY_ERROR['frequency']:g} %",
        "systems": [
            (case.name, shown(systems[case.name]), remarks(motions))
            for case, motions in result.systems.items()
        ],
        "pictures": list(figures),
        "window": EQ_11,
    }
    answer = _answer(result, judged)
    return Report("studies/reproduce/report.md", values, tables, figures, answer)


def _answer(result: Reproduction, judged: Sequence[Verdict]) -> str:
    """Return what the gradient saves over the printed energies, and how many claims hold."""
    terms = 6
    saved = [
        1 - result.free(row.condition, terms).energy / row.energy
        for row in ROWS
        if row.terms == terms and row.energy
    ]
    words = (
        f"With {terms} terms and at rest, the gradient takes {percents(saved)} less energy than "
        "the paper prints."
    )
    if judged:
        holding = sum(verdict.holds for verdict in judged)
        words += f" {holding} of the paper's {len(judged)} claims hold."
    return words


def _redrawn(result: Reproduction, title: str, case: Case, against_earlier: bool) -> Figure:
    """The paper's motions of a condition; with what search and gradient find for N = 6.

    In Figs 2 and 5 over the numbers of terms; in Figs 3 and 6 over the earlier study's input, as it
    is read here.
    """
    reference, name = case.earlier
    earlier = result.earlier(case)
    of_search, of_earlier_search = variants("search", 2)
    two_terms, four_terms, six_terms = reversed(variants("paper", 3))
    lines = [Line(result.cycloid(case), "cycloid")]
    if against_earlier and earlier is not None:
        label = f"{name} of ref. [{reference}] as read here, gradient"
        lines = [
            *_by_search(
                result,
                case,
                name,
                of_earlier_search,
            ),
            Line(earlier, label, RED, "--"),
        ]
    else:
        lines += [_of_paper(case, 2, two_terms), _of_paper(case, 4, four_terms)]
    gradient = result.in_box(case, SIX_TERMS)
    lines += [
        _of_paper(case, SIX_TERMS, six_terms),
        *_by_search(result, case, SIX_TERMS, of_search),
        Line(gradient, "gradient, N = 6, same bounds", PLAN.colour, PLAN.dash),
    ]
    return motion_figure(
        lines,
        f"{title} redrawn: {title_of(case.task)}",
        PAPER_PANELS,
    )


def _by_search(result: Reproduction, case: Case, which: Input, look: Look) -> list[Line]:
    """The middle seed of the paper's search; none where that did not come near enough."""
    searched = result.searched.get((case, which))
    label = f"{f'N = {which}' if isinstance(which, int) else which}, {case.search_label}"
    middle = searched and searched.middle
    return [Line(middle, label, look.colour, look.dash)] if middle else []


def _of_paper(case: Case, terms: int, look: Look) -> Line:
    """The paper's own coefficients, a misprint mended."""
    plan: Plan | None = paper_plan(case, terms)
    assert plan is not None  # it prints those of these figures
    label = f"paper, N = {terms}{', a_5 mended' * ((case, terms) in MENDED)}"
    return Line(plan, label, look.colour, look.dash)
