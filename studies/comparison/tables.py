"""A comparison of fronts in tables and in words."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from quietarm.metaheuristics.ensemble import Spread
from quietarm.studies.comparison.measures import Comparison, Group
from quietarm.studies.display.words import millimetres
from quietarm.studies.report.table import Cell, Column, Table

_ENERGY, _SHARE, _PERCENT = "{:.5g}".format, "{:.4f}".format, "{:.2f}".format
_MISS = "{:.2g}".format


def tables(comparison: Comparison) -> dict[str, Table]:
    """The tables that are shown, by name: fronts, energies, coverage."""
    return {
        "fronts": _fronts(comparison),
        "energies": _energies(comparison),
        "coverage": _coverage(comparison),
    }


def _fronts(comparison: Comparison) -> Table:
    columns = (
        Column("method"),
        Column("bound on coefficients", "{:g}".format),
        Column("coefficients"),
        Column("seeds"),
        Column("points", "{:.0f}".format),
        Column("hypervolume (more is better)", _SHARE),
        *_quartile_columns(_SHARE),
        Column("  as found", _SHARE),
        Column("IGD+ (less is better)", _MISS),
        *_quartile_columns(_MISS),
        Column("epsilon (less is better)", _MISS),
        *_quartile_columns(_MISS),
        Column("candidates", "{:.0f}".format),
        Column("solver iterations", "{:.0f}".format),
        Column("time of a run [s]", "{:.1f}".format),
    )
    rows: list[list[Cell]] = []
    filling = comparison.fill > 0
    for group in comparison.groups:
        front = group.runs[0].front
        bound, several = front.settings.get("bound"), len(group.runs) > 1
        row: list[Cell] = [group.label, "none" if bound is None else bound, front.profile.size]
        row += [len(group.runs) if several else None, _points(group)]
        for figure in ("hypervolume", "igd_plus", "epsilon"):
            row += _quartiles(group.spread(figure), several)
            if figure == "hypervolume":
                row.append(group.spread("hypervolume_found").median if filling else None)
        row += [
            group.spread(f"front.{work}").median or None for work in ("evaluations", "iterations")
        ]
        row.append(group.spread("front.seconds").median)
        rows.append(row)
    return Table("Fronts", columns, rows)


def _points(group: Group) -> float:
    return Spread.of([len(run.front.points) for run in group.runs]).median


def _energies(comparison: Comparison) -> Table:
    columns = [Column("method")]
    for level in comparison.levels:
        where = f"at {millimetres(level)}"
        columns += [
            Column(f"energy {where} [J]", _ENERGY),
            *_quartile_columns(_ENERGY),
            Column(f"  above the best {where} [%]", _PERCENT),
            Column("  with motions between its points", _PERCENT),
            Column("  seeds that reach it"),
        ]
    rows: list[list[Cell]] = []
    for group in comparison.groups:
        row: list[Cell] = [group.label]
        for i in range(len(comparison.levels)):
            row += _at_level(group, i, comparison.fill > 0)
        rows.append(row)
    return Table("Least energy within a residual", columns, rows)


def _at_level(group: Group, level: int, filling: bool) -> list[Cell]:
    reached, runs = group.reached(level), len(group.runs)
    if not reached:
        return ["not reached", None, None, None, None, None]
    energy = group.spread("energies", level)
    gap = 100 * group.spread("gaps", level).median
    return [
        *_quartiles(energy, reached > 1),
        gap,
        100 * group.spread("gaps_between", level).median if filling else None,
        f"{reached} of {runs}" if reached < runs else None,
    ]


def _coverage(comparison: Comparison) -> Table:
    labels = [group.label for group in comparison.groups]
    columns = [
        Column("points beaten or equalled [%]"),
        *(Column(f"  by {label}", "{:.0f}".format) for label in labels),
    ]
    rows: list[list[Cell]] = [
        [label, *(100 * share if isfinite(share) else None for share in shares)]
        for label, shares in zip(labels, comparison.coverage.T.tolist(), strict=True)
    ]
    return Table("Coverage", columns, rows)


def runs_table(comparison: Comparison) -> Table:
    """Every run with all of its figures, for CSV."""
    levels = [f"{1e3 * level:g}mm" for level in comparison.levels]
    names = [
        "name", "label", "method", "seed", "bound", "coefficients", "points", "hypervolume",
        "hypervolume_found", "igd_plus", "epsilon",
        *(f"{name}_at_{at}" for name in ("energy_J", "gap", "gap_between") for at in levels),
        "evaluations", "iterations", "seconds", "complete",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for group in comparison.groups:
        for run in group.runs:
            front, figures = run.front, (*run.energies, *run.gaps, *run.gaps_between)
            row: list[Cell] = [run.name, group.label, front.method, front.seed]
            row += [front.settings.get("bound"), front.profile.size, len(front.points)]
            row += [run.hypervolume, run.hypervolume_found, run.igd_plus, run.epsilon]
            row += [figure if isfinite(figure) else None for figure in figures]
            row += [
                front.evaluations,
                front.iterations,
                front.seconds,
                "yes" if front.complete else "no",
            ]
            rows.append(row)
    return Table("Runs", [Column(name) for name in names], rows)


def how_to_read(comparison: Comparison) -> list[str]:
    """What the figures of any comparison mean, a sentence or two each."""
    lines = [
        "A front is read as a staircase: its energy at a residual is the least that was found with "
        "that residual or less."
    ]
    if comparison.fill:
        lines[0] += (
            " The steps of a front of few points would count against it. So every front is "
            "filled: between neighbouring points, motions with interpolated coefficients are "
            f"evaluated, about {comparison.fill} for each front. The indicators, and the best that "
            "energies are compared with, are those of filled fronts."
        )
    else:
        lines[0] += (
            " Motions between points do not count, so a front of few points loses by its steps."
        )
    lines.append(
        "Coverage: share of the points found that the other front, filled, dominates or equals."
    )
    if any(len(group.runs) > 1 for group in comparison.groups):
        lines.append(
            "For several seeds the tables show the median over those that reach the residual (for "
            "two, their mean); the picture shows what at least half of the seeds reach (for two, "
            "the better one)."
        )
    return lines


def units(comparison: Comparison) -> list[str]:
    """What this comparison's figures are measured in and against, a sentence or two each."""
    (residual, energy), (length, joules) = comparison.corner, comparison.extent
    lines = [
        f"Hypervolume: share of the box up to {millimetres(residual)} and {energy:.4g} J, the same "
        "for all, that a front dominates.",
        f"IGD+ and (additive) epsilon are measured against {comparison.reference}, thinned to even "
        "distances. Both objectives are scaled: 1 is the extent of that front, "
        f"{millimetres(length)} or {joules:.4g} J. IGD+ is the mean distance by which a front "
        "misses it, epsilon the least shift in both objectives that makes up for the worst miss.",
    ]
    if comparison.floor is not None:
        lines.append(
            "Floor: the least energy found over all joint motions that arrive "
            f"{comparison.of_floor}, not of polynomials only, is {comparison.floor:.4g} J. A front "
            "may go below it where it leaves a residual."
        )
    return lines


def _quartile_columns(form: Callable[[float], str]) -> tuple[Column, Column]:
    return Column("  lower quartile of the seeds", form), Column("  upper quartile", form)


def _quartiles(spread: Spread, several: bool) -> list[Cell]:
    """The median, and the quartiles where there are several seeds."""
    return [spread.median, *([spread.lower, spread.upper] if several else [None, None])]
