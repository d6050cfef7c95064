"""What `quietarm reproduce` shows and writes: the paper's tables and figures, systems, claims."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import pandas as pd
from matplotlib.figure import Figure
from quietarm.ocp import Plan
from quietarm.studies.compare.front_report import spread_words
from quietarm.studies.compare.plans import motions_table, remarks, shown
from quietarm.studies.figures import BLUE, GREEN, PAPER_PANELS, RED, Line, motion_figure
from quietarm.studies.figures.looks import ORANGE, PINK
from quietarm.studies.report import Report
from quietarm.studies.report.words import title_of
from quietarm.studies.reproduce.claims import claims
from quietarm.studies.reproduce.paper import (
    ARM_HALF,
    MENDED,
    ROWS,
    SINGLE_LINK_SIXTH,
    SIX,
    Case,
    Row,
    paper_plan,
)
from quietarm.studies.reproduce.recompute import FREQUENCY_ERROR, Reproduction
from quietarm.studies.reproduce.searched import SIX_TERMS, Input, Searched

TITLES = {
    2: "Table 2: number of terms, single link",
    3: "Table 3: against ref. [23], single link",
    5: "Table 5: number of terms, arm on a flexible link",
    6: "Table 6: against ref. [24], arm on a flexible link",
}
_STYLES = {2: (GREEN, "-."), 4: (RED, "--"), 6: (BLUE, "-")}  # hues of the paper's Figs 2 and 5


def paper_table(result: Reproduction, number: int) -> pd.DataFrame:
    """One of the paper's tables, the recomputed figures beside the printed ones."""
    return pd.DataFrame([dict(_cells(result, r)) for r in ROWS if r.table == number]).dropna(
        axis=1, how="all"
    )


def _cells(result: Reproduction, row: Row) -> Iterator[tuple[str, object]]:
    """Names and figures of a row; energies [J], residuals [mm]."""
    case, terms = row.condition, row.terms
    found = result.searched[case, terms]
    yield "move", case.label
    yield "terms N", terms
    reference, name = case.earlier
    if row.earlier_energy is not None:
        yield f"ref. [{reference}], printed [J]", row.earlier_energy
        yield f"{name} as read here, gradient [J]", _energy(result.earlier(case))
    yield "paper, printed [J]", row.energy
    printed, mended = result.printed(case, terms), paper_plan(case, terms)
    yield "printed coefficients [J]", _energy(printed)
    yield "  residual [mm]", printed and 1e3 * printed.residual
    if (case, terms) in MENDED and mended:
        yield "a_5 mended [J]", mended.energy
        yield "  residual of it [mm]", 1e3 * mended.residual
    yield f"{case.search_label} [J]", spread_words(found.energies, ".4g")
    yield "  within [mm]", 1e3 * found.level
    yield "  time of a run [s]", found.seconds
    yield "gradient, in the box [J]", result.in_box(case, terms).energy
    yield "gradient, no box [J]", result.free(case, terms).energy


def _energy(plan: Plan | None) -> float | None:
    return None if plan is None else plan.energy


def six_table(result: Reproduction) -> pd.DataFrame:
    """The six conditions: what is printed, the paper's search with both inputs, the gradient."""
    rows: list[dict[str, object]] = []
    for row in SIX:
        case, (reference, name) = row.condition, row.condition.earlier
        earlier, six = result.searched[case, name], result.searched[case, SIX_TERMS]
        floor = result.floor(case)
        rows.append({
            "condition": case.name,
            "search": case.search_label,
            "within [mm]": 1e3 * six.level,
            "earlier study": f"{name}, ref. [{reference}]",
            "printed there [J]": row.earlier_energy,
            "its input, searched [J]": spread_words(earlier.energies, ".4f"),
            "its input, gradient [J]": _energy(result.earlier(case)),
            "paper, printed [J]": row.energy,
            "six terms, searched [J]": spread_words(six.energies, ".4f"),
            "six terms, gradient in the box [J]": result.in_box(case, SIX_TERMS).energy,
            "six terms, gradient [J]": result.free(case, SIX_TERMS).energy,
            "any motion at rest [J]": floor.energy,
            "both solvers differ by": result.checks[case].largest,
        })  # fmt: skip
    return pd.DataFrame(rows)


def reproduction_report(result: Reproduction) -> Report:
    """The paper's tables and figures; of full effort the six conditions, systems and claims."""
    tables = {f"table_{number}": paper_table(result, number) for number in TITLES}
    judged = claims(result) if result.effort.full else []
    systems = {case: motions_table(every) for case, every in result.systems.items()}
    if result.effort.full:
        tables["six"] = six_table(result)
        tables["claims"] = pd.DataFrame(
            {"claim": one.claim, "verdict": one.word, "figures": "; ".join(one.figures)}
            for one in judged
        )
        tables["systems"] = pd.concat(
            table.assign(condition=case.name) for case, table in systems.items()
        )
    pictures = {
        "figure_2.png": partial(_redrawn, result, SINGLE_LINK_SIXTH, "Fig. 2"),
        "figure_3.png": partial(_against_earlier, result, SINGLE_LINK_SIXTH, "Fig. 3"),
        "figure_5.png": partial(_redrawn, result, ARM_HALF, "Fig. 5"),
        "figure_6.png": partial(_against_earlier, result, ARM_HALF, "Fig. 6"),
    }
    return Report(
        "reproduce/report.md",
        {
            "titles": TITLES,
            "seeds": result.effort.seeds,
            "full": result.effort.full,
            "claims": judged,
            "error": f"{100 * FREQUENCY_ERROR['frequency']:g} %",
            "systems": [
                (case.name, shown(table), remarks(result.systems[case]))
                for case, table in systems.items()
            ],
            "pictures": list(pictures),
        },
        tables,
        pictures,
    )


def _redrawn(result: Reproduction, case: Case, title: str) -> Figure:
    """Fig. 2 or 5 from the printed coefficients, with what search and gradient find for N = 6."""
    lines = [Line(result.cycloid(case), "cycloid", "black")]
    lines += [_of_paper(case, terms, *style) for terms, style in _STYLES.items()]
    lines += _by_search(result, case, SIX_TERMS, PINK)
    lines.append(
        Line(result.in_box(case, SIX_TERMS), "gradient, N = 6, same box", ORANGE, (0, (7, 2)))
    )
    return motion_figure(lines, f"{title} redrawn: {title_of(case.task)}", PAPER_PANELS)


def _against_earlier(result: Reproduction, case: Case, title: str) -> Figure:
    """Fig. 3 or 6: the paper's coefficients over the earlier study's input as read here."""
    (reference, name), earlier = case.earlier, result.earlier(case)
    lines = _by_search(result, case, name, ORANGE)
    if earlier is not None:
        lines.append(
            Line(earlier, f"{name} of ref. [{reference}] as read here, gradient", RED, ":")
        )
    lines.append(_of_paper(case, SIX_TERMS, BLUE, "-"))
    lines += _by_search(result, case, SIX_TERMS, PINK)
    lines.append(
        Line(result.in_box(case, SIX_TERMS), "gradient, N = 6, same box", GREEN, (0, (7, 2)))
    )
    return motion_figure(lines, f"{title} redrawn: {title_of(case.task)}", PAPER_PANELS)


def _by_search(result: Reproduction, case: Case, which: Input, colour: str) -> list[Line]:
    """The middle seed of the paper's search; none where that did not come near enough."""
    found: Searched | None = result.searched.get((case, which))
    label = f"{f'N = {which}' if isinstance(which, int) else which}, {case.search_label}"
    return (
        [] if found is None or found.middle is None else [Line(found.middle, label, colour, "--")]
    )


def _of_paper(case: Case, terms: int, colour: str, style: str) -> Line:
    """The paper's own coefficients, a misprint mended."""
    plan, mended = paper_plan(case, terms), ", a_5 mended" * ((case, terms) in MENDED)
    assert plan is not None  # it prints those of these figures
    return Line(plan, f"paper, N = {terms}{mended}", colour, style)
