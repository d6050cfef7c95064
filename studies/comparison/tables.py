"""A comparison of fronts in tables and in words."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from operator import attrgetter

from quietarm.metaheuristics.ensemble import Spread
from quietarm.studies.comparison.measures import Comparison
from quietarm.studies.display.words import millimetres
from quietarm.studies.document.prose import told
from quietarm.studies.document.table import Cell, Column, Line, Table, table_of
from quietarm.studies.registry.methods import Kind

_ENERGY, _SHARE, _PERCENT, _COUNT, _MISS = "{:.5g}", "{:.4f}", "{:.2f}", "{:.0f}", "{:.2g}"


_INDICATORS = ("hypervolume", "hypervolume_found", "igd_plus", "epsilon")
_WORK = ("evaluations", "iterations", "seconds")


def tables(comparison: Comparison) -> dict[str, Table]:
    """The tables that are shown, by name: fronts, energies, coverage."""
    return {
        "fronts": _fronts(comparison),
        "energies": _energies(comparison),
        "coverage": _coverage(comparison),
    }


def summary(comparison: Comparison) -> Table:
    """A row for each method, medians alone: what is looked for first."""
    columns = [
        *map(Column, ("method", "seeds")),
        *(Column(millimetres(level), _ENERGY.format) for level in comparison.levels),
        Column("time [s]", "{:.1f}".format),
    ]
    rows: list[list[Cell]] = []
    for group in comparison.groups:
        energies = [group.spread("energies", i).median for i in range(len(comparison.levels))]
        stated = [_reached(one) for one in energies]
        seconds = group.spread("front.seconds").median
        cells: list[Cell] = [group.label, len(group.runs), *stated, seconds]
        rows.append([column.text(cell) for column, cell in zip(columns, cells, strict=True)])
    return Table("Least energy F2 [J] within a residual, medians", columns, rows).turned()


def _fronts(comparison: Comparison) -> Table:
    groups = comparison.groups
    fronts = [group.runs[0].front for group in groups]
    bounds = [front.settings.get("bound") for front in fronts]
    points = [Spread.of([len(run.front.points) for run in group.runs]) for group in groups]

    def medians(figure: str) -> list[float]:
        return [group.spread(figure).median for group in groups]

    # the points of an exact front are some of a line, and would lose by steps that it has not
    are_points = [group.method.kind is not Kind.GRADIENT for group in groups]
    whole = [comparison.fill > 0 or are for are in are_points]

    def spreads(heading: str, form: str, figure: str) -> list[Line]:
        found = [group.spread(figure) for group in groups]
        known = [of if shown else Spread.of([]) for of, shown in zip(found, whole, strict=True)]
        return _quartiles(heading, form, known)

    as_found = [
        volume if are else None
        for are, volume in zip(are_points, medians("hypervolume_found"), strict=True)
    ]
    columns: list[Line] = [
        ("method", "", [group.label for group in groups]),
        ("bound on coefficients", "{:g}", ["none" if b is None else b for b in bounds]),
        ("coefficients", "", [front.profile.size for front in fronts]),
        ("seeds", "", [len(group.runs) for group in groups]),
        ("points", _COUNT, [spread.median for spread in points]),
        *spreads("hypervolume (more is better)", _SHARE, "hypervolume"),
        *([("  as found", _SHARE, as_found)] if comparison.fill else []),
        *spreads("IGD+ (less is better)", _MISS, "igd_plus"),
        *spreads("epsilon (less is better)", _MISS, "epsilon"),
        ("candidates", _COUNT, [median or None for median in medians("front.evaluations")]),
        ("solver iterations", _COUNT, [median or None for median in medians("front.iterations")]),
        ("time of a run [s]", "{:.1f}", medians("front.seconds")),
    ]
    return table_of("Fronts", columns)


def _energies(comparison: Comparison) -> Table:
    groups = comparison.groups
    columns: list[Line] = [("method", "", [group.label for group in groups])]
    for i, level in enumerate(comparison.levels):
        where = f"at {millimetres(level)}"
        energies = [group.spread("energies", i) for group in groups]
        (heading, form, _), *quartiles = _quartiles(f"energy {where} [J]", _ENERGY, energies)
        medians = [spread.median for spread in energies]
        stated = [_reached(one) for one in medians]
        gaps = [100 * group.spread("gaps", i).median for group in groups]
        between = [
            100 * group.spread("gaps_between", i).median
            if comparison.fill and group.reached(i)
            else None
            for group in groups
        ]
        seeds = [f"{e.count} of {e.seeds}" if 0 < e.count < e.seeds else None for e in energies]
        columns += [
            (heading, form, stated),
            *quartiles,
            (f"  above the best {where} [%]", _PERCENT, gaps),
            ("  with motions between its points", _PERCENT, between),
            (f"  seeds that have a motion {where}", "", seeds),
        ]
    return table_of("Least energy within a residual", columns)


def _quartiles(heading: str, form: str, spreads: Sequence[Spread]) -> list[Line]:
    """The median, and the quartiles where there are several seeds."""
    lower, upper = (
        [_reached(getattr(spread, side)) if spread.count > 1 else None for spread in spreads]
        for side in ("lower", "upper")
    )
    return [
        (heading, form, [spread.median for spread in spreads]),
        ("  lower quartile of the seeds", form, lower),
        ("  upper quartile", form, upper),
    ]


def _reached(energy: float) -> Cell:
    return energy if isfinite(energy) else "not reached"


def _coverage(comparison: Comparison) -> Table:
    labels = [group.label for group in comparison.groups]
    columns: list[Line] = [("points beaten or equalled [%]", "", labels)]
    for label, shares in zip(labels, 100 * comparison.coverage, strict=True):
        columns.append((f"  by {label}", _COUNT, shares.tolist()))
    return table_of("Coverage", columns)


def runs_table(comparison: Comparison) -> Table:
    """Every run with all of its figures, for CSV."""
    levels = [f"at_{1e3 * level:g}mm" for level in comparison.levels]
    names = ["name", "label", "method", "seed", "bound", "coefficients", "points", *_INDICATORS]
    names += [f"{name}_{at}" for name in ("energy_J", "gap", "gap_between") for at in levels]
    rows: list[list[Cell]] = []
    for group in comparison.groups:
        for run in group.runs:
            front = run.front
            row = [run.name, group.label, front.method, front.seed, front.settings.get("bound")]
            row += [front.profile.size, len(front.points), *attrgetter(*_INDICATORS)(run)]
            row += [*run.energies, *run.gaps, *run.gaps_between, *attrgetter(*_WORK)(front)]
            rows.append([*row, "yes" if front.complete else "no"])
    cells = zip([*names, *_WORK, "complete"], zip(*rows, strict=True), strict=True)
    return table_of("Runs", [(name, "", column) for name, column in cells])


def how_to_read(comparison: Comparison) -> list[str]:
    """What the figures of any comparison mean, a sentence or two each."""
    several = any(len(group.runs) > 1 for group in comparison.groups)
    return told("comparison/reading.txt", fill=comparison.fill, several=several)


def units(comparison: Comparison) -> list[str]:
    """What this comparison's figures are measured in and against, a sentence or two each."""
    return told("comparison/units.txt", one=comparison)
