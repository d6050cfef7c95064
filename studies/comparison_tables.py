"""A comparison of fronts in tables and in words."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from metaheuristics.ensemble import Spread
from studies.comparison import Comparison, Group
from studies.tables import Cell, Column, Table

_ENERGY, _SHARE, _PERCENT = "{:.5g}".format, "{:.4f}".format, "{:.2f}".format
_MISS = "{:.2g}".format
_QUARTILES = "  quartiles over seeds"


def tables(comparison: Comparison) -> dict[str, Table]:
    """The tables for people, by the name of their file: fronts, energies, coverage."""
    return {
        "fronts": _fronts(comparison),
        "energies": _energies(comparison),
        "coverage": _coverage(comparison),
    }


def _fronts(comparison: Comparison) -> Table:
    columns = (
        Column("method"),
        Column("bound on the coefficients", "{:g}".format),
        Column("coefficients"),
        Column("seeds"),
        Column("points", "{:.0f}".format),
        Column("hypervolume (large is good)", _SHARE),
        Column(_QUARTILES),
        Column("  as found", _SHARE),
        Column("IGD+ (small is good)", _MISS),
        Column(_QUARTILES),
        Column("additive epsilon (small is good)", _MISS),
        Column(_QUARTILES),
        Column("candidates, or iterations of the gradient", "{:.0f}".format),
        Column("time of a run [s]", "{:.1f}".format),
    )
    rows: list[list[Cell]] = []
    filling = comparison.fill > 0
    for group in comparison.groups:
        front = group.runs[0].front
        bound, several = front.settings.get("bound"), len(group.runs) > 1
        row: list[Cell] = [group.label, "none" if bound is None else bound, front.profile.size]
        row += [len(group.runs) if several else None, _points(group)]
        for figure, show in (("hypervolume", _SHARE), ("igd_plus", _MISS), ("epsilon", _MISS)):
            spread = group.spread(figure)
            row += [spread.median, _quartiles(spread, show) if several else None]
            if figure == "hypervolume":
                row.append(group.spread("hypervolume_found").median if filling else None)
        row += [group.spread(figure).median for figure in ("evaluations", "seconds")]
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
            Column(_QUARTILES),
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
        return ["not reached", None, None, None, None]
    energy = group.spread("energies", level)
    gap = 100 * group.spread("gaps", level).median
    return [
        energy.median,
        _quartiles(energy, _ENERGY) if reached > 1 else None,
        gap,
        100 * group.spread("gaps_between", level).median if filling else None,
        f"{reached} of {runs}" if reached < runs else None,
    ]


def _coverage(comparison: Comparison) -> Table:
    labels = [group.label for group in comparison.groups]
    columns = [
        Column("share [%] of the points of"),
        *(Column(f"beaten or equalled by {label}", "{:.0f}".format) for label in labels),
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
        "evaluations", "seconds", "complete",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for group in comparison.groups:
        for run in group.runs:
            front, figures = run.front, (*run.energies, *run.gaps, *run.gaps_between)
            row: list[Cell] = [run.name, group.label, front.method, front.seed]
            row += [front.settings.get("bound"), front.profile.size, len(front.points)]
            row += [run.hypervolume, run.hypervolume_found, run.igd_plus, run.epsilon]
            row += [figure if isfinite(figure) else None for figure in figures]
            row += [front.evaluations, front.seconds, "yes" if front.complete else "no"]
            rows.append(row)
    return Table("Runs", [Column(name) for name in names], rows)


def how_to_read(comparison: Comparison) -> list[str]:
    """What the figures mean, a sentence or two each."""
    (residual, energy), (length, joules) = comparison.corner, comparison.extent
    lines = [
        "A front is a staircase: within a residual only those motions count that were found with "
        "that residual or less."
        + (
            " A front of few points would lose by its steps alone. So fronts are filled, all "
            "alike: motions with coefficients between those of neighbours are evaluated, until "
            f"there are about {comparison.fill}. Indicators, and the best that energies are "
            "measured against, are those of filled fronts."
            if comparison.fill
            else " Motions between them do not count: fronts of few points lose by their steps."
        ),
        f"Hypervolume: share of the box up to {millimetres(residual)} and {energy:.4g} J, the same "
        "for all, that a front dominates.",
        f"IGD+ and additive epsilon are against {comparison.reference}, thinned to even distances. "
        f"Both objectives weigh alike: 1 is the extent of that front, {millimetres(length)} or "
        f"{joules:.4g} J. IGD+ is the mean distance by which a front misses it, epsilon the least "
        "shift in both objectives that makes up for the worst miss.",
        "Coverage: share of the points found that the other front, filled, dominates or equals.",
    ]
    if any(len(group.runs) > 1 for group in comparison.groups):
        lines.append("Of several seeds the median is shown, over those that reach the residual.")
    if comparison.floor is not None:
        lines.append(
            f"Floor: the least energy found over all joint motions that arrive at rest, not of "
            f"polynomials only, is {comparison.floor:.4g} J. A front may go below it where it "
            "leaves a residual."
        )
    return lines


def millimetres(length: float) -> str:
    """A length as people read it."""
    return f"{length * 1e3:.3g} mm"


def _quartiles(spread: Spread, show: Callable[[float], str]) -> str:
    return f"{show(spread.lower)} to {show(spread.upper)}"
