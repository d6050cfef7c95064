"""Every figure of report.md from the files beside it, with moocore, scipy and numpy, not quietarm.

    python recompute.py            compares them with figures.json, and the pages with the figures
    python recompute.py --write    writes figures.json

report.md and appendix.md are filled in from figures.json by templates of the repository, which need
quietarm for the names of methods: without it the figures alone are compared. What the files hold is
in appendix.md, under "Files".
"""

from __future__ import annotations

import argparse
import csv
import json
import lzma
import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata, spearmanr, wilcoxon

sys.path.append(str(Path(__file__).parent))
from recompute_basins import basins_figures

Array = NDArray[np.float64]
CORNER = 1.1
"""Areas are dominated up to here, where a problem's scale goes from 0 to 1."""
UNIT = 1e-4
"""Motions between are kept in whole multiples of this share of the scale."""
LEVEL = 0.05
TERMS = (2, 4, 6, 10, 16, 24)
CENTRE = 6
BUDGETS = (1_000, 10_000, 100_000)
OF_MAP = ("centre", "crossing", "large")
"""Tables that have the runs of the map."""
CONTROL = "epsilon"
CONTROL_SETTINGS = "points=50"
DIFFERENCES = "slsqp"
KINDS = ("absolute", "copper", "stages", "motor-map", "integer")
PAPER = ("nsga2-paper", "vepso")
TARGETS = (50, 20, 10, 5, 2, 1)
"""Missing hypervolumes [%] that a run may attain."""
DRAWN = (
    "epsilon points=10", "epsilon points=50", "multistart starts=100", "memetic", "gde3",
    "moead-de", "nsga2", "slsqp",
)  # fmt: skip
"""What the picture of attained targets shows: eight lines at most."""
MEASURES = ("points", "between")
"""Hypervolume of 50 points; of the 100 best with motions between them."""
INDICATORS = (*MEASURES, "igd+", "epsilon", "energy")
"""IGD+ and additive epsilon of 50 points; energy within 1 mm."""
NO_SUCH_MOTION = 1e3
"""Excess of energy [%] that counts for a front without a motion within 1 mm."""
LIMITS = ("torque-tight", "torque-loose", "jerk-tight", "jerk-loose")
FURTHER = {
    "robust": (CENTRE, "absolute-robust"),
    "polynomial": (10, "absolute"),
    "spline": (10, "absolute-spline"),
    "gaussians": (10, "absolute-gaussians"),
    "terms": (CENTRE, "integer"),
    "shaper": (CENTRE, "shaper"),
}
"""Further axes: coefficients and kind of their problems."""
FURTHER_METHODS = ("moead-de", "gde3", "nsga2", DIFFERENCES)
OF_FURTHER = ("robust", "profiles", "integers", "crossing", "energy")
"""Tables that have their runs."""
IN_TURN = f"{DIFFERENCES} in-turn=True"
"""SLSQP that takes every value of an integer in turn."""
CORES = 100
TIMES = (10, 30, 100, 250)
"""Time on these cores, in evaluations that follow one another."""


@dataclass(frozen=True)
class Run:
    """A row of a table of runs, with its points in the scale of its problem."""

    axis: str
    problem: str
    method: str
    settings: str
    budget: int
    seed: int
    seconds: float
    energy: float
    points: Array
    between: Array
    marks: Array

    @property
    def label(self) -> str:
        """The method with its settings."""
        return f"{self.method} {self.settings}".strip()


@dataclass(frozen=True)
class Problem:
    """What a problem's name says."""

    name: str

    @cached_property
    def move(self) -> str:
        """Its plant and number."""
        return re.split(r"(?<=-m\d)-", self.name)[0]

    @cached_property
    def plant(self) -> str:
        """Of its move."""
        return self.move.rpartition("-")[0]

    @cached_property
    def terms(self) -> int:
        """Coefficients."""
        return int(self.name.removeprefix(f"{self.move}-").partition("-")[0])

    @cached_property
    def kind(self) -> str:
        """Of its energy."""
        return self.name.removeprefix(f"{self.move}-").partition("-")[2]


def numbers(text: str) -> Array:
    """The numbers of a cell."""
    return np.array(text.split(), dtype=float)


def read_runs(folder: Path) -> list[Run]:
    """All runs of the tables of a folder."""
    with (folder / "scales.csv").open(newline="") as file:
        scales = {row["problem"]: row for row in csv.DictReader(file)}
    runs = list[Run]()
    for path in sorted((folder / "runs").glob("*.csv.xz")):
        with lzma.open(path, "rt", newline="") as file:
            for row in csv.DictReader(file):
                runs.append(run_of(row, scales[row["problem"]], path.name.partition(".")[0]))
    return runs


def run_of(row: Mapping[str, str], scale: Mapping[str, str], axis: str) -> Run:
    """A row as a run."""
    least = np.append(
        np.array([scale["least_residual_m"], scale["least_energy_J"]], dtype=float),
        numbers(scale.get("least_peaks") or ""),
    )
    largest = np.append(
        np.array([scale["largest_residual_m"], scale["largest_energy_J"]], dtype=float),
        numbers(scale.get("largest_peaks") or ""),
    )
    points = np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_mJ"])]) * 1e-3
    for peak in filter(None, (row.get("peaks") or "").split(";")):
        points = np.column_stack([points, numbers(peak)])
    between = np.column_stack([numbers(row["between_residuals"]), numbers(row["between_energies"])])
    marks = [numbers(row[name]) for name in ("marks_evaluations", "marks_seconds", "marks_area")]
    return Run(
        axis,
        row["problem"],
        row["method"],
        row["settings"],
        int(row["budget"] or 0),
        int(row["seed"]),
        float(row["seconds"]),
        float(row["energy_1mm_J"]),
        (points - least) / (largest - least),
        between * UNIT,
        np.column_stack(marks),
    )


def area(points: Array) -> float:
    """Return the area that points of a scale dominate, up to the corner."""
    if not len(points):
        return 0.0
    return float(moocore.hypervolume(points, ref=[CORNER] * points.shape[1]))


def best_known(points: Array) -> float:
    """The area that counts as a hundred per cent: of all points of all runs of a problem.

    Of two objectives it is the area above the straight lines through the best of them, the last
    extended to the corner, so that it does not grow with the number of points on one curve.
    """
    inside = points[(points < CORNER).all(axis=1)]
    best = moocore.filter_dominated(inside)
    if points.shape[1] > 2:
        return area(best)
    x, y = best[np.argsort(best[:, 0])].T
    x = np.append(x, CORNER)
    y = np.append(y, y[-1])
    return float(np.sum(np.diff(x) * (CORNER - (y[1:] + y[:-1]) / 2)))


class Results:
    """Runs, and what each lacks of the best that is known of its problem."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.runs = read_runs(folder)
        self.gather()

    def gather(self) -> None:
        """Bring the points of all runs of a problem together: what the gaps are measured by."""
        points_of = defaultdict[str, list[Array]](list)
        energies = defaultdict[str, list[float]](list)
        for run in self.runs:
            points_of[run.problem].append(run.points)
            if len(run.between):  # of two objectives alone
                points_of[run.problem].append(run.between)
            energies[run.problem].append(run.energy)
        self.points = {name: np.vstack(points) for name, points in points_of.items()}
        self.whole = {name: best_known(points) for name, points in self.points.items()}
        self.least_energy = {
            name: min(filter(np.isfinite, values), default=np.inf)
            for name, values in energies.items()
        }
        self._gaps = dict[tuple[int, str], float]()
        self._table = defaultdict[tuple[str, int, str], list[Run]](list)
        for run in self.runs:
            self._table[run.label, run.budget, run.problem].append(run)

    def missing(self, run: Run, measure: str) -> float:
        """Per cent of the best known area."""
        points = run.points if measure == "points" else run.between
        return 100 * (1 - area(points) / self.whole[run.problem])

    def excess(self, run: Run, measure: str = "") -> float:
        """Energy within 1 mm over the least known [%]; infinite where there is no such motion."""
        if not np.isfinite(run.energy):
            return np.inf
        return 100 * (run.energy / self.least_energy[run.problem] - 1)

    @cached_property
    def reference(self) -> dict[str, Array]:
        """The best points of all runs of a problem, without and with motions between."""
        return {name: moocore.filter_dominated(points) for name, points in self.points.items()}

    def gap(self, run: Run, indicator: str) -> float:
        """How far a front is from the best that is known [%], by an indicator.

        Of the best known hypervolume, of the problem's scale (IGD+, epsilon), or of the energy.
        """
        key = id(run), indicator
        if key not in self._gaps:
            self._gaps[key] = self._gap(run, indicator)
        return self._gaps[key]

    def _gap(self, run: Run, indicator: str) -> float:
        if indicator in MEASURES:
            return self.missing(run, indicator)
        if indicator == "energy":
            return min(self.excess(run), NO_SUCH_MOTION)
        if not len(run.points):
            return NO_SUCH_MOTION
        distance = moocore.igd_plus if indicator == "igd+" else moocore.epsilon_additive
        return 100 * float(distance(run.points, ref=self.reference[run.problem]))

    def of(self, label: str, budget: int, problem: str) -> list[Run]:
        """The runs of a method with its settings on a problem."""
        return self._table.get((label, budget, problem), [])

    def median(
        self, runs: Iterable[Run], value: Callable[[Run, str], float], measure: str
    ) -> float:
        """Over seeds; a method that repeats itself counts once as it is."""
        return float(np.median([value(run, measure) for run in runs]))

    def control(self, problem: str) -> list[Run]:
        """The gradient's front of 50 points; of 20 where the energy jumps, of 200 with peaks."""
        several = Problem(problem).kind.endswith("objectives")
        settings = "points=200" if several else CONTROL_SETTINGS
        runs = self.of(f"{CONTROL} {settings}", 0, problem)
        return runs or self.of(f"{CONTROL} points=20", 0, problem)

    def control_within(self, problem: str, seconds: float) -> list[Run]:
        """The gradient's front that took longest, and no longer; none where all took longer."""
        rungs = [
            run
            for run in self.runs_of_problem[problem]
            if run.method == CONTROL and run.seed == 0 and run.seconds <= seconds
        ]
        return sorted(rungs, key=lambda run: run.seconds)[-1:]

    @cached_property
    def runs_of_problem(self) -> Mapping[str, list[Run]]:
        """All runs by problem."""
        table = defaultdict[str, list[Run]](list)
        for run in self.runs:
            table[run.problem].append(run)
        return table

    def problems(self, terms: int = CENTRE, kind: str = "absolute") -> list[str]:
        """Names of the problems that have runs."""
        return [
            name
            for name in sorted(self.whole)
            if (Problem(name).terms, Problem(name).kind) == (terms, kind)
        ]


def holm(values: Sequence[float]) -> list[float]:
    """Adjusted p values; those that are missing stay so and do not count."""
    order = sorted((p, i) for i, p in enumerate(values) if np.isfinite(p))
    adjusted = [float("nan")] * len(values)
    largest = 0.0
    for rank, (p, i) in enumerate(order):
        largest = max(largest, min(1.0, p * (len(order) - rank)))
        adjusted[i] = largest
    return adjusted


def least_p(moves: int) -> float:
    """The smallest p that signed ranks of so many moves can give."""
    return 2 / 2**moves


def signed_ranks(differences: Array) -> float:
    """Wilcoxon's p, two-sided; NaN where nothing differs."""
    differences = differences[differences != 0]
    return float(wilcoxon(differences).pvalue) if len(differences) else float("nan")


def interval(values: Array, plants: Sequence[str], draws: int = 2000) -> tuple[float, float]:
    """Of the median over moves, 95 %: plants are drawn again, then moves of each."""
    places, counts = drawn_again(tuple(plants), draws)
    drawn = np.sort(np.append(values, np.inf)[places], axis=1)  # what is beyond a count is last
    rows = np.arange(draws)
    medians = (drawn[rows, (counts - 1) // 2] + drawn[rows, counts // 2]) / 2
    low, high = np.quantile(medians, [0.025, 0.975])
    return float(low), float(high)


@cache
def drawn_again(plants: tuple[str, ...], draws: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Places of moves in each draw of plants and moves, -1 beyond their count; and the counts."""
    random = np.random.default_rng(52)
    blocks = [np.flatnonzero(np.array(plants) == plant) for plant in sorted(set(plants))]
    places = np.full((draws, len(blocks) * max(map(len, blocks))), -1)
    counts = np.empty(draws, dtype=np.intp)
    for draw in range(draws):
        chosen = random.integers(len(blocks), size=len(blocks))
        moves = np.concatenate([random.choice(blocks[i], len(blocks[i])) for i in chosen])
        counts[draw] = len(moves)
        places[draw, : len(moves)] = moves
    return places, counts


Rival = Callable[[str, float], list[Run]]
"""Runs on a problem that a search is held against, by the processor time that it took."""


def compare(
    results: Results,
    problems: Sequence[str],
    searches: Sequence[tuple[str, int]],
    measure: str,
    rival: Rival | None = None,
    with_intervals: bool = True,
) -> list[dict[str, Any]]:
    """Every search against the gradient, or another rival, over the problems that all have.

    Its row has medians over problems, Wilcoxon's p and Holm's, in how many plants and moves the
    search is nearer, and the decimal logarithm of the ratio of what both lack, with its interval.
    These are of the problems alone on which the rival has a front.
    """
    against: Rival = rival or (lambda name, spent: results.control(name))
    problems = [
        name
        for name in problems
        if results.control(name) and all(results.of(*search, name) for search in searches)
    ]
    plants = [Problem(name).plant for name in problems]
    rows = list[dict[str, Any]]()
    for label, budget in searches:
        runs = [results.of(label, budget, name) for name in problems]
        lacks = np.array([results.median(r, results.gap, measure) for r in runs])
        excess = np.array([results.median(r, results.excess, measure) for r in runs])
        seconds = np.array([np.median([run.seconds for run in r]) for r in runs])
        controls = [against(name, spent) for name, spent in zip(problems, seconds, strict=True)]
        known = np.array([bool(control) for control in controls], dtype=bool)
        theirs = np.array(
            [results.median(control, results.gap, measure) for control in controls if control]
        )
        row: dict[str, Any] = {
            "method": label,
            "budget": budget,
            "moves": len(problems),
            "seeds": min((len(r) for r in runs), default=0),
            "missing": _median(lacks),
            "control": _median(theirs),
            "control_seconds": _median(
                np.array([np.median([r.seconds for r in runs]) for runs in controls if runs])
            ),
            "no_control": int((~known).sum()),
            "excess": _median(excess),
            "seconds": _median(seconds),
        }
        if known.any():
            floor = 1e-3  # per cent: what the files' digits can tell
            lacks = lacks[known]
            of_known = [plant for plant, has in zip(plants, known, strict=True) if has]
            ratios = np.log10(np.maximum(lacks, floor) / np.maximum(theirs, floor))
            by_plant = [np.median(ratios[np.array(of_known) == plant]) for plant in set(of_known)]
            row |= {
                "p": signed_ranks(lacks - theirs),
                "log_ratio": float(np.median(ratios)),
                "interval": interval(ratios, of_known) if with_intervals else None,
                "moves_nearer": int((lacks < theirs).sum()),
                "plants_nearer": int(sum(value < 0 for value in by_plant)),
                "plants": len(by_plant),
            }
        rows.append(row)
    for row, p in zip(rows, holm([row.get("p", np.nan) for row in rows]), strict=True):
        row["holm"] = p
    return rows


def _median(values: Array) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def searches_in(results: Results, axes: Sequence[str], budget: int, problems: Sequence[str],
                least: int) -> list[tuple[str, int]]:  # fmt: skip
    """Searches with runs of a budget on at least so many of the problems."""
    names = set(problems)
    count = defaultdict[str, set[str]](set)
    for run in results.runs:
        if run.axis in axes and run.budget == budget and run.problem in names:
            count[run.label].add(run.problem)
    return sorted((label, budget) for label, known in count.items() if len(known) >= least)


def takes_slopes(label: str) -> bool:
    """Whether a method of candidates takes the gradient's steps, or differences."""
    return any(word in label for word in ("memetic", "+polish", DIFFERENCES))


def searches_of_cell(
    results: Results, terms: int, budget: int, crossed: Sequence[str]
) -> list[tuple[str, int]]:
    """The searches of a cell of the map that see values alone."""
    return [
        (label, spent)
        for label, spent in searches_in(results, OF_MAP, budget, results.problems(terms), 5)
        if label.partition(" ")[0] in crossed and not takes_slopes(label)
    ]


def cell(results: Results, terms: int, budget: int, crossed: Sequence[str]) -> dict[str, Any]:
    """A cell of the map: the nearest search against the gradient or differences, in six ways."""
    problems = results.problems(terms)
    searches = searches_of_cell(results, terms, budget, crossed)
    rivals: dict[str, Rival] = {
        "to its end": lambda name, spent: results.control(name),
        "same time": results.control_within,
        "differences": by_label(results, DIFFERENCES, budget),
    }
    ways = {}
    for measure in MEASURES:
        for title, rival in rivals.items():
            rows = compare(results, problems, searches, measure, rival)
            rows = [row for row in rows if row["moves"]]
            if not rows:
                continue
            best = min(rows, key=lambda row: row["missing"])
            compared = best["moves"] - best["no_control"]
            best["compared"] = compared
            best["least_p_holm"] = least_p(compared) * len(rows)
            best["enough"] = bool(best["least_p_holm"] <= LEVEL)
            best["verdict"] = bool(best["enough"] and best["holm"] <= LEVEL)
            best["no_front"] = 2 * best["no_control"] > best["moves"]
            ways[f"{measure}, {title}"] = best
    return {"terms": terms, "budget": budget, "ways": ways}


def by_indicator(results: Results, crossed: Sequence[str]) -> dict[str, dict[str, int]]:
    """The best search of each cell of the map against the gradient to its end, by indicator.

    Comparisons over cells and moves, and cells with a verdict before and after Holm's correction
    over the cells.
    """
    figures = {}
    for indicator in INDICATORS:
        best = list[dict[str, Any]]()
        for budget in BUDGETS:
            for terms in TERMS:
                problems = results.problems(terms)
                searches = searches_of_cell(results, terms, budget, crossed)
                rows = compare(results, problems, searches, indicator, with_intervals=False)
                rows = [row for row in rows if row["moves"]]
                if rows:
                    best.append(min(rows, key=lambda row: row["missing"]))
        over_cells = holm([row["holm"] for row in best])
        verdicts = {"search": 0, "gradient": 0, "search_over_cells": 0, "gradient_over_cells": 0}
        for row, p in zip(best, over_cells, strict=True):
            winner = "search" if row["log_ratio"] < 0 else "gradient"
            verdicts[winner] += row["holm"] <= LEVEL
            verdicts[f"{winner}_over_cells"] += p <= LEVEL
        figures[indicator] = {
            "cells": len(best),
            "comparisons": sum(row["moves"] for row in best),
            "search_better": sum(row["moves_nearer"] for row in best),
            **{name: int(count) for name, count in verdicts.items()},
        }
    return figures


def limit_figures(results: Results) -> dict[str, dict[str, Any]]:
    """With limits, by kind and budget: all methods against the gradient, and searches by rival."""
    figures = dict[str, dict[str, Any]]()
    for limits in LIMITS:
        problems = results.problems(kind=f"absolute-{limits}")
        for budget in (200, 1_000, 10_000):
            methods = searches_in(results, ("limits",), budget, problems, 5)
            if not methods:
                continue
            searches = [pair for pair in methods if not takes_slopes(pair[0])]
            figures[f"{limits}, {budget}"] = {
                "limits": limits,
                "budget": budget,
                "methods": compare(results, problems, methods, "between"),
                "same time": compare(
                    results, problems, searches, "between", results.control_within
                ),
                "differences": compare(
                    results, problems, searches, "between", by_label(results, DIFFERENCES, budget)
                ),
            }
    return figures


def few_figures(results: Results) -> list[dict[str, Any]]:
    """With 200 and 1,000 candidates, without and with noise of 1 %."""
    figures = list[dict[str, Any]]()
    problems = sorted({run.problem for run in results.runs if run.axis == "few"})
    for budget in (200, 1_000):
        for noise in ("", "noise=0.01"):
            labels = sorted(
                {
                    run.label
                    for run in results.runs
                    if run.axis in ("few", "crossing")
                    and run.budget == budget
                    and run.problem in problems
                    and ("noise=0.01" in run.settings) == bool(noise)
                }
            )
            methods = [
                (label, budget)
                for label in labels
                if 2 * sum(bool(results.of(label, budget, name)) for name in problems)
                > len(problems)
            ]
            if not methods:
                continue
            rows = compare(results, problems, methods, "between")
            steps = [row for row in rows if row["method"].startswith(DIFFERENCES)]
            best_steps = min(steps, key=lambda row: row["missing"])
            rival = by_label(results, best_steps["method"], budget)
            searches = [pair for pair in methods if not takes_slopes(pair[0])]
            figures.append(
                {
                    "budget": budget,
                    "noise": 0.01 if noise else 0.0,
                    "methods": rows,
                    "differences": compare(results, problems, searches, "between", rival),
                }
            )
    return figures


def further_figures(results: Results) -> dict[str, list[dict[str, Any]]]:
    """By further axis: for each budget all methods against the gradient, and searches by rival."""
    figures = dict[str, list[dict[str, Any]]]()
    for axis, (terms, kind) in FURTHER.items():
        problems = [name for name in results.problems(terms, kind) if results.control(name)]
        if axis == "polynomial":  # on the moves of the other families
            moves = {Problem(name).move for name in results.problems(terms, "absolute-spline")}
            problems = [name for name in problems if Problem(name).move in moves]
        figures[axis] = []
        for budget in (1_000, 10_000):
            run_there = [name for name in problems if results.of(DIFFERENCES, budget, name)]
            methods = searches_in(results, OF_FURTHER, budget, run_there, max(len(run_there), 5))
            methods = [pair for pair in methods if pair[0].split()[0] in (*FURTHER_METHODS, "es")]
            if not methods:
                continue
            rival = IN_TURN if (IN_TURN, budget) in methods else DIFFERENCES
            searches = [pair for pair in methods if not takes_slopes(pair[0])]
            figures[axis].append(
                {
                    "budget": budget,
                    "rival": rival,
                    "methods": compare(results, problems, methods, "between"),
                    "differences": compare(
                        results, problems, searches, "between", by_label(results, rival, budget)
                    ),
                }
            )
    return figures


def energy_of_families(results: Results) -> list[dict[str, Any]]:
    """Energy within 1 mm of each family's fronts over that of the polynomial's by the gradient [%].

    Medians over the moves of all families, with as many coefficients; a front without such a
    motion counts as infinite.
    """
    names = {
        family: {
            Problem(name).move: name
            for name in results.problems(*FURTHER[family])
            if results.control(name) and results.of("moead-de", 10_000, name)
        }
        for family in ("polynomial", "spline", "gaussians")
    }
    names = {family: by_move for family, by_move in names.items() if by_move}
    moves = sorted(set.intersection(*(set(by_move) for by_move in names.values())))
    figures = list[dict[str, Any]]()
    for family in names:
        for label, budget in ((f"{CONTROL} {CONTROL_SETTINGS}", 0), ("moead-de", 10_000)):
            ratios = [
                np.median([run.energy if np.isfinite(run.energy) else np.inf for run in runs])
                / results.control(names["polynomial"][move])[0].energy
                for move in moves
                if (runs := results.of(label, budget, names[family][move]))
            ]
            if ratios:
                above = 100 * (float(np.median(ratios)) - 1)
                figures.append(
                    {"family": family, "method": label, "moves": len(ratios), "above": above}
                )
    return figures


def parallel_figures(results: Results) -> dict[str, Any]:
    """Return the gaps after a time on many cores, where every evaluation takes as long.

    A call for so many candidates takes as many evaluations one after another as there are rounds
    of all cores. A run counts as it stood at its last mark before: 10,000 candidates, then
    100,000. SLSQP from random starts has as many of them side by side as cores are enough for, and
    is taken from a run of one after another.
    """
    path = results.folder / "batches.csv"
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    asked = defaultdict[str, list[float]](list)
    calls = defaultdict[str, list[float]](list)
    for row in rows:
        label = f"{row['method']} {row['settings']}".strip()
        side_by_side = 1
        if "continuation=False" in label:
            side_by_side = CORES // int(row["largest_call"])
        rate = int(row["candidates"]) / int(row[f"time_on_{CORES}_cores"])
        asked[label].append(side_by_side * rate)
        calls[label].append(int(row["candidates"]) / int(row["calls"]))
    candidates = {label: float(np.median(values)) for label, values in asked.items()}
    long_runs = {run.problem for run in results.runs if run.axis == "large"}
    problems = [name for name in results.problems() if name in long_runs]
    figures = dict[str, Any]()
    for cores, times in ((1, (100, 1_000, 10_000)), (CORES, TIMES)):
        for time in times:
            gaps = dict[str, Array]()
            for label, rate in candidates.items():
                afforded = time * (rate if cores > 1 else 1.0)
                values = [gap_after(results, name, label, afforded) for name in problems]
                if np.isfinite(values).all():
                    gaps[label] = np.array(values)
            figures[f"{cores}, {time}"] = {
                "cores": cores,
                "time": time,
                "rows": against_best_differences(gaps),
            }
    return {
        "moves": len(problems),
        "candidates": candidates,
        "per_call": {label: float(np.median(values)) for label, values in calls.items()},
        "times": figures,
    }


def against_best_differences(gaps: Mapping[str, Array]) -> list[dict[str, Any]]:
    """Medians over moves, and each search against the way of SLSQP with the smaller median."""
    ways = [label for label in gaps if label.startswith(DIFFERENCES)]
    rival = min(ways, key=lambda label: float(np.median(gaps[label])))
    rows = [
        {
            "method": label,
            "missing": float(np.median(values)),
            "better": int((values < gaps[rival]).sum()),
            "p": float("nan") if label in ways else signed_ranks(values - gaps[rival]),
        }
        for label, values in gaps.items()
    ]
    for row, p in zip(rows, holm([row["p"] for row in rows]), strict=True):
        row["holm"] = p
    return rows


def gap_after(results: Results, problem: str, label: str, candidates: float) -> float:
    """Gap of 50 points when a method has asked for so many candidates [%], median over seeds.

    NaN where no run is long enough, but for a run of 100,000, which is as long as any.
    """
    for budget in (10_000, 100_000):
        runs = results.of(label, budget, problem)
        if runs and (candidates <= budget or budget == BUDGETS[-1]):
            areas = [run.marks[run.marks[:, 0] <= candidates, 2] for run in runs]
            last = [reached[-1] if len(reached) else 0.0 for reached in areas]
            return float(np.median([100 * (1 - area / results.whole[problem]) for area in last]))
    return float("nan")


@dataclass(frozen=True)
class Row:
    """A row of the report's first table: a search against one rival, on one or more kinds.

    The search, and the settings of SLSQP, are those of the least median gap on the first seeds; of
    several kinds of problem, those whose largest median is least. Fresh seeds judge them.
    """

    name: str
    axes: tuple[str, ...]
    budget: int
    kinds: tuple[str, ...] = ("absolute",)
    noise: str = ""
    rival: str = DIFFERENCES
    measure: str = "between"


FIRST_SEEDS = 3
EQUAL = 0.5
"""Two gaps that differ by less [percentage points] are equal for practice; set beforehand."""
OF_LIMITS = tuple(f"absolute-{limits}" for limits in LIMITS)
ROWS = (
    Row("model", ("centre",), 10_000, rival=CONTROL),
    Row("smooth", ("centre",), 10_000),
    Row("limits", ("limits",), 10_000, OF_LIMITS),
    Row("limits-1000", ("limits",), 1_000, OF_LIMITS),
    Row("limits-200", ("limits",), 200, OF_LIMITS),
    Row("jumps", ("energy",), 10_000, ("motor-map",)),
    Row("noise", ("noise",), 10_000, noise="noise=0.01"),
    Row("few-200", ("few",), 200),
    Row("few-200-noise", ("few",), 200, noise="noise=0.01"),
    Row("few-1000", ("few", "crossing"), 1_000),
    Row("few-1000-noise", ("few",), 1_000, noise="noise=0.01"),
    Row("three", ("objectives",), 10_000, ("absolute-3-objectives",), "", CONTROL, "points"),
    Row("four", ("objectives",), 10_000, ("absolute-4-objectives",), "", CONTROL, "points"),
)


def judged_rows(results: Results) -> list[dict[str, Any]]:
    """The first table: every row's search, chosen on the first seeds and judged on fresh ones.

    Holm's p is over all comparisons of the table, each by the indicator of its row. By any other
    indicator it is over all comparisons by that one.
    """
    rows = [judged(results, row) for row in ROWS]
    comparisons = [(row, comparison) for row in rows for comparison in row["comparisons"]]
    of_indicators = [
        [comparison["by"][name] for _, comparison in comparisons if name in comparison["by"]]
        for name in INDICATORS
    ]
    of_table = [comparison["by"][row["measure"]] for row, comparison in comparisons]
    for tests in (*of_indicators, of_table):
        for test, p in zip(tests, holm([test["p"] for test in tests]), strict=True):
            test["holm"] = p
    return rows


def judged(results: Results, row: Row) -> dict[str, Any]:
    """A row with its search, the rival's settings and a comparison for each kind of problem."""
    problems_of = {kind: results.problems(kind=kind) for kind in row.kinds}
    every = [name for problems in problems_of.values() for name in problems]
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, every, 5)
        if (f" {label}".partition(" noise=")[1] != "") == bool(row.noise)
        and "continuation" not in label
        and (not row.noise or label.endswith(row.noise))
    ]
    searches = [label for label in labels if not takes_slopes(label)]
    steps = [label for label in labels if label.partition(" ")[0] == DIFFERENCES]
    search = chosen_on_first(results, row, searches, problems_of)
    rival = CONTROL if row.rival == CONTROL else chosen_on_first(results, row, steps, problems_of)
    return {
        "row": row.name,
        "budget": row.budget,
        "measure": row.measure,
        "search": search,
        "rival": rival,
        "comparisons": [
            comparison
            for kind, problems in problems_of.items()
            if (comparison := judged_on(results, row, (search, rival), kind, problems))
        ],
    }


def seeds_of(results: Results, row: Row, label: str, name: str, fresh: bool) -> list[Run]:
    """The runs of a method on a problem, of the first seeds or of fresh ones."""
    runs = results.of(label, row.budget, name)
    return [run for run in runs if (run.seed >= FIRST_SEEDS) == fresh]


def chosen_on_first(
    results: Results, row: Row, labels: Sequence[str], problems_of: Mapping[str, Sequence[str]]
) -> str:
    """The method of the least median gap on the first seeds, on problems that all have.

    Of those alone that were run on most problems of every kind that any was run on.
    """

    def known(label: str, problems: Sequence[str]) -> set[str]:
        return {name for name in problems if seeds_of(results, row, label, name, False)}

    def is_on_most(label: str, problems: Sequence[str]) -> bool:
        most = max(len(known(other, problems)) for other in labels)
        return 2 * len(known(label, problems)) > max(most, 1)

    of_all = [
        label
        for label in labels
        if all(is_on_most(label, problems) for problems in problems_of.values())
    ]
    worst = dict[str, float]()
    for label in of_all:
        medians = list[float]()
        for problems in problems_of.values():
            shared = set.intersection(*(known(other, problems) for other in of_all))
            runs = [seeds_of(results, row, label, name, False) for name in sorted(shared)]
            gaps = [results.median(of_name, results.gap, row.measure) for of_name in runs]
            medians.append(float(np.median(gaps)))
        worst[label] = max(medians)
    return min(worst, key=lambda label: worst[label], default="")


def judged_on(
    results: Results, row: Row, pair: tuple[str, str], kind: str, problems: Sequence[str]
) -> dict[str, Any]:
    """A search and its rival on fresh seeds, by every indicator; nothing where there are none."""
    search, rival = pair
    ours = dict[str, list[Run]]()
    theirs = dict[str, list[Run]]()
    for name in problems:
        of_search = seeds_of(results, row, search, name, True)
        of_rival = seeds_of(results, row, rival, name, True)
        of_rival = results.control(name) if rival == CONTROL else of_rival
        if of_search and of_rival and results.control(name):
            ours[name], theirs[name] = of_search, of_rival
    if len(ours) < 5:
        return {}
    seeds = [len(runs) for runs in ours.values()]
    if rival != CONTROL:
        seeds = [min(pair) for pair in zip(seeds, map(len, theirs.values()), strict=True)]
    controls = {name: results.control(name) for name in ours}
    plants = [Problem(name).plant for name in ours]

    def gaps(runs_of: Mapping[str, list[Run]], indicator: str) -> Array:
        runs = runs_of.values()
        return np.array([results.median(of_name, results.gap, indicator) for of_name in runs])

    by = dict[str, dict[str, Any]]()
    for indicator in INDICATORS:
        if indicator == "between" and row.measure == "points":
            continue  # of three and four objectives there are no motions between
        difference = gaps(ours, indicator) - gaps(theirs, indicator)
        by[indicator] = {
            "better": int((difference < 0).sum()),
            "difference": float(np.median(difference)),
            "p": signed_ranks(difference),
        }
    difference = gaps(ours, row.measure) - gaps(theirs, row.measure)
    by_plant = [np.median(difference[np.array(plants) == plant]) for plant in sorted(set(plants))]
    return {
        "kind": kind.removeprefix("absolute").removeprefix("-"),
        "moves": len(ours),
        "seeds": min(seeds),
        "missing": float(np.median(gaps(ours, row.measure))),
        "control": float(np.median(gaps(theirs, row.measure))),
        "gradient": float(np.median(gaps(controls, row.measure))),
        "equal": int((np.abs(difference) < EQUAL).sum()),
        "interval": interval(difference, plants),
        "plants": len(by_plant),
        "plants_better": int(sum(value < 0 for value in by_plant)),
        "by": by,
    }


def by_label(results: Results, label: str, budget: int) -> Rival:
    """A method with a budget as the rival of searches."""
    return lambda name, spent: results.of(label, budget, name)


def usual_label(results: Results, method: str, budget: int) -> str:
    """The label by which a method's usual settings stand in the map.

    Where its runs state a population these are the settings with most individuals: smaller ones
    are for few candidates.
    """
    stated = [
        label
        for label, _ in searches_in(results, OF_MAP, budget, list(results.whole), 1)
        if label.startswith(f"{method} population=")
    ]
    return max(stated, key=lambda label: int(label.rpartition("=")[2]), default=method)


def lines_over(
    results: Results,
    places: Sequence[tuple[float, int, int]],
    methods: Sequence[str],
) -> dict[str, dict[str, dict[str, list[float]]]]:
    """Medians over moves of what methods and the gradient lack, by measure and method.

    A place is where a line goes on, and its coefficients and budget. All places of a line have the
    moves that every one of them has.
    """
    control = f"{CONTROL} {CONTROL_SETTINGS}"
    fewest = 5

    def runs_at(method: str, terms: int, budget: int) -> dict[str, list[Run]]:
        spent = 0 if method == control else budget
        label = usual_label(results, method, spent)
        runs_of = {name: results.of(label, spent, name) for name in results.problems(terms)}
        return {Problem(name).move: runs for name, runs in runs_of.items() if runs}

    table = {
        (method, x): runs_at(method, terms, budget)
        for method in (control, *methods)
        for x, terms, budget in places
    }
    table = {place: by_move for place, by_move in table.items() if len(by_move) >= fewest}
    moves = set.intersection(*map(set, table.values())) if table else set()
    lines: dict[str, dict[str, dict[str, list[float]]]] = {}
    for measure in MEASURES:
        lines[measure] = {}
        for (method, x), by_move in table.items():
            lacks = [results.median(by_move[move], results.gap, measure) for move in moves]
            line = lines[measure].setdefault(method, {"x": [], "y": []})
            line["x"].append(x)
            line["y"].append(max(float(np.median(lacks)), 1e-3))
    return lines


def tuned(results: Results) -> list[dict[str, Any]]:
    """Default and tuned settings by cell and method on the moves of testing, and what was tried.

    Holm's p is over all methods of all cells.
    """
    figures = list[dict[str, Any]]()
    for (cell, method), tried in trials_of(results.folder).items():
        best = best_trial(tried)
        row = row_of_cell(cell)
        label = label_of_best(results, row, method, tried)
        figures.append(
            {
                "cell": cell,
                "method": method,
                "trials": len(tried),
                "budget": int(best["budget"]),
                "default_score": 10 ** float(tried[0]["score"]),
                "best_score": 10 ** float(best["score"]),
                "settings": json.loads(best["settings"]),
                **on_testing(results, row, method, label),
            }
        )
    for measure in MEASURES:
        adjust([row[measure] for row in figures if measure in row])
    return figures


def both_tuned(results: Results) -> list[dict[str, Any]]:
    """Every search against SLSQP in its cell, both with default settings and both tuned.

    Holm's p is over all of these with default settings, and over all of them tuned.
    """
    figures = list[dict[str, Any]]()
    label_of = {
        (cell, method): label_of_best(results, row_of_cell(cell), method, tried)
        for (cell, method), tried in trials_of(results.folder).items()
    }
    for (cell, method), label in label_of.items():
        rival = label_of.get((cell, DIFFERENCES))
        if method == DIFFERENCES or rival is None:
            continue
        row = row_of_cell(cell)
        pairs = {
            "default": (usual_in(results, row, method), usual_in(results, row, DIFFERENCES)),
            "tuned": (label, rival),
        }
        labels = [name for pair in pairs.values() for name in pair]
        problems = tested_on(results, row, labels)
        if problems:
            of_pairs = {
                name: held_against(results, row, pair, problems, "between")
                for name, pair in pairs.items()
            }
            figures.append({"cell": cell, "method": method, "problems": len(problems), **of_pairs})
    for name in ("default", "tuned"):
        adjust([row[name] for row in figures])
    return figures


def adjust(tests: Sequence[dict[str, Any]]) -> None:
    """Give tests Holm's p over all of them."""
    for test, p in zip(tests, holm([test["p"] for test in tests]), strict=True):
        test["holm"] = p


def trials_of(folder: Path) -> dict[tuple[str, str], list[dict[str, str]]]:
    """The trials by cell and method, cells in the order of the first table's rows."""
    path = folder / "tuning.csv"
    trials = defaultdict[tuple[str, str], list[dict[str, str]]](list)
    if path.exists():
        with path.open(newline="") as file:
            for trial in csv.DictReader(file):
                trials[trial["cell"], trial["method"]].append(trial)
    return dict(sorted(trials.items(), key=lambda place: ROWS.index(row_of_cell(place[0][0]))))


def best_trial(trials: Sequence[Mapping[str, str]]) -> Mapping[str, str]:
    """The trial of the least score, the first of equals."""
    return min(trials, key=lambda trial: float(trial["score"]))


def row_of_cell(cell: str) -> Row:
    """The row of the first table that rests on a cell."""
    return next(row for row in ROWS if row.name == ("smooth" if cell == "centre" else cell))


def tuned_label(method: str, trial: Mapping[str, str], row: Row) -> str:
    """The label of runs with a trial's settings."""
    settings = dict(sorted(json.loads(trial["settings"]).items()))
    again = settings.pop("reevaluate", 1)
    words = [f"{name}={value}" for name, value in settings.items()]
    words += [f"reevaluate={again}"] if again > 1 else []
    return " ".join([method, *words, *filter(None, [row.noise])])


def label_of_best(
    results: Results, row: Row, method: str, trials: Sequence[Mapping[str, str]]
) -> str:
    """The label of the best trial's runs: those of the usual settings, where none was better.

    The first trial has the usual settings; without noise they are not run again. A method with
    fewer than eight trials is being tuned still.
    """
    best = best_trial(trials)
    label = tuned_label(method, best, row)
    is_usual = best is trials[0] and not row.noise and len(trials) >= 8
    return (
        usual_in(results, row, method)
        if is_usual and not tested_on(results, row, [label])
        else label
    )


def usual_in(results: Results, row: Row, method: str) -> str:
    """The label of a method in a row of the first table: its best one on the first seeds."""
    problems_of = {kind: results.problems(kind=kind) for kind in row.kinds}
    problems = [name for names in problems_of.values() for name in names]
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, problems, 5)
        if label.partition(" ")[0] == method
        and "continuation" not in label
        and ("noise=" in label) == bool(row.noise)
        and label.endswith(row.noise)
    ]
    return chosen_on_first(results, row, labels, problems_of)


def tested_on(results: Results, row: Row, labels: Sequence[str]) -> list[str]:
    """The problems of a row on which all of these were run."""
    return [
        name
        for kind in row.kinds
        for name in results.problems(kind=kind)
        if all(results.of(label, row.budget, name) for label in labels)
    ]


def held_against(
    results: Results, row: Row, pair: tuple[str, str], problems: Sequence[str], measure: str
) -> dict[str, Any]:
    """A method against another: gaps, on how many problems it is better, and Wilcoxon's p.

    The test is over moves: of several kinds of problem a move's differences count as their mean.
    """
    ours, theirs = (
        np.array(
            [
                results.median(results.of(label, row.budget, name), results.gap, measure)
                for name in problems
            ]
        )
        for label in pair
    )
    moves = np.array([Problem(name).move for name in problems])
    differences = np.array([(ours - theirs)[moves == move].mean() for move in sorted(set(moves))])
    return {
        "first": float(np.median(ours)),
        "second": float(np.median(theirs)),
        "better": int((ours < theirs).sum()),
        "difference": float(np.median(differences)),
        "p": signed_ranks(differences),
    }


def on_testing(results: Results, row: Row, method: str, label: str) -> dict[str, Any]:
    """Default and tuned settings on the moves of testing, by measure; nothing where not run.

    Beside them the method that the row holds against this one, with the settings of the row.
    """
    if not tested_on(results, row, [label]):
        return {}
    usual = usual_in(results, row, method)
    of_row = judged(results, row)
    other = of_row["search"] if method == DIFFERENCES else of_row["rival"]
    problems = tested_on(results, row, [label, usual, other])
    if not problems:
        return {}
    figures: dict[str, Any] = {"usual": usual, "other": other}
    for measure in MEASURES:
        of_default = held_against(results, row, (label, usual), problems, measure)
        of_other = held_against(results, row, (label, other), problems, measure)
        figures[measure] = {
            "moves": len(problems),
            "default": of_default["second"],
            "tuned": of_default["first"],
            "nearer": of_default["better"],
            "p": of_default["p"],
            "other": of_other["second"],
            "nearer_than_other": of_other["better"],
            "p_other": of_other["p"],
        }
    return figures


def attained(results: Results, problems: Sequence[str], labels: Sequence[tuple[str, int]],
             times: Array) -> dict[str, list[float]]:  # fmt: skip
    """Share of targets on all problems that a method has attained, over processor time."""
    shares = {}
    for label, budget in labels:
        reached = np.zeros(len(times))
        total = 0
        for name in problems:
            for run in results.of(label, budget, name):
                lacks = 100 * (1 - run.marks[:, 2] / results.whole[name])
                for target in TARGETS:
                    at = run.marks[lacks <= target, 1]
                    total += 1
                    if len(at):
                        reached += times >= at[0]
        if total:
            shares[label] = [float(share) for share in reached / total]
    return shares


def runtime_profiles(results: Results) -> dict[str, Any]:
    """Share of targets attained over candidates per coefficient, as COCO's runtime profiles.

    Six coefficients and 10,000 candidates, without and with limits. A run's values are those of 50
    points at its marks. Runs are not restarted: one that ends above a target never attains it. The
    best of all is, for each problem and target, the method whose runs need the fewest candidates in
    the median.
    """
    per_coefficient = np.logspace(0, np.log10(10_000 / CENTRE), 61)
    targets = np.logspace(np.log10(50), 0, 51)
    limited = [name for kind in LIMITS for name in results.problems(kind=f"absolute-{kind}")]
    profiles = dict[str, dict[str, list[float]]]()
    problems_of = dict[str, int]()
    for title, axis, problems in (
        ("no limits", "centre", results.problems()),
        ("limits", "limits", limited),
    ):
        labels = [label for label, _ in searches_in(results, (axis,), 10_000, problems, 10)]
        labels = [label for label in labels if "memetic" not in label and "polish" not in label]
        of_all = [name for name in problems if all(results.of(m, 10_000, name) for m in labels)]
        if not (labels and of_all):
            continue
        spent = {label: candidates_to(results, of_all, label, targets) for label in labels}
        spent["best of all"] = np.min([np.median(rows, axis=1) for rows in spent.values()], axis=0)
        problems_of[title] = len(of_all)
        profiles[title] = {
            label: [float((rows <= limit * CENTRE).mean()) for limit in per_coefficient]
            for label, rows in spent.items()
        }
    return {
        "per_coefficient": per_coefficient.tolist(),
        "targets": [float(targets[0]), float(targets[-1]), len(targets)],
        "problems": problems_of,
        "shares": profiles,
    }


def candidates_to(results: Results, problems: Sequence[str], label: str, targets: Array) -> Array:
    """Candidates of a method's runs until each target, shape (problems, runs, targets).

    Infinite where a run never attains it. Of each problem as many runs count as every one has.
    """
    of_problem = [results.of(label, 10_000, name) for name in problems]
    count = min(map(len, of_problem))
    rows = list[list[Array]]()
    for name, runs in zip(problems, of_problem, strict=True):
        rows.append([])
        for run in runs[:count]:
            lacks = 100 * (1 - run.marks[:, 2] / results.whole[name])
            lowest = np.minimum.accumulate(np.append(np.inf, lacks))[1:]
            first = np.searchsorted(-lowest, -targets)
            rows[-1].append(np.append(run.marks[:, 0], np.inf)[first])
    return np.array(rows)


def black_box_figures(folder: Path) -> list[dict[str, Any]]:
    """Gaps on black boxes, of the points alone, to the best points of all runs [%].

    The scale goes from the least to the largest values of those points.
    """
    path = folder / "black_box.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    figures = list[dict[str, Any]]()
    for problem in dict.fromkeys(row["problem"] for row in rows):
        of_problem = [row for row in rows if row["problem"] == problem]
        points = [
            np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_mJ"])])
            for row in of_problem
        ]
        best = moocore.filter_dominated(np.vstack(points))
        least = best.min(axis=0)
        extent = np.ptp(best, axis=0)
        whole = area((best - least) / extent)
        gaps = defaultdict[tuple[str, int], list[float]](list)
        seconds = defaultdict[tuple[str, int], list[float]](list)
        for row, found in zip(of_problem, points, strict=True):
            key = row["method"], int(row["candidates"])
            gaps[key].append(100 * (1 - area((found - least) / extent) / whole))
            seconds[key].append(float(row["seconds"]))
        figures += [
            {
                "problem": problem,
                "method": method,
                "candidates": candidates,
                "runs": len(values),
                "missing": float(np.median(values)),
                "least": min(values),
                "most": max(values),
                "seconds": float(np.median(seconds[method, candidates])),
            }
            for (method, candidates), values in gaps.items()
        ]
    return figures


def repeats(results: Results) -> dict[str, int]:
    """On how many problems the gradient's fronts of two seeds are the same."""
    same = 0
    several = 0
    for problem in results.problems():
        runs = results.control(problem)
        if len(runs) < 2:
            continue
        several += 1
        first = runs[0].points
        same += all(
            len(first) == len(run.points) and np.abs(first - run.points).max() < 1e-5
            for run in runs[1:]
        )
    return {"problems": several, "same": same}


def beaten(results: Results) -> dict[str, Any]:
    """Where another run has less energy within 1 mm than the gradient's front of 50 points."""
    share = 0.1  # per cent: more than rounding and tolerances of the points
    excess = {
        name: results.excess(runs[0])
        for name in results.whole
        if not Problem(name).kind.endswith("objectives")
        and np.isfinite(results.least_energy[name])
        and (runs := results.control(name))
    }
    worse = {name: value for name, value in excess.items() if value > share}
    return {"problems": len(excess), "share": share, "excess": dict(sorted(worse.items()))}


FEATURES = ("coefficients", "best_basin", "condition", "walk_residual", "walk_energy",
            "within_1mm", "within_5mm", "opposed")  # fmt: skip


def prediction(
    results: Results, budget: int, crossed: Sequence[str], measure: str
) -> dict[str, Any]:
    """What tells the winner: features of problems, tested on plants that were left out.

    The outcome of a problem is the logarithm of what the nearest search lacks over what the
    gradient lacks. A rule is a feature and a threshold that tell the sign best; it is made from
    four plants and tried on the fifth, beside the rule that always says what is more frequent.
    """
    path = results.folder / "landscapes.csv"
    with path.open(newline="") as file:
        rows = {row["problem"]: row for row in csv.DictReader(file)}
    data = list[tuple[str, list[float], float]]()
    shown = list[dict[str, Any]]()
    for name, row in sorted(rows.items()):
        searches = [label for label in crossed if not takes_slopes(label)]
        runs = [r for label in searches if (r := results.of(label, budget, name))]
        if len(runs) < len(searches) or not results.control(name):
            continue
        lacks = min(results.median(r, results.gap, measure) for r in runs)
        theirs = results.median(results.control(name), results.gap, measure)
        values = [float(row[feature] or "nan") for feature in FEATURES]
        outcome = float(np.log10(max(lacks, 1e-3) / max(theirs, 1e-3)))
        data.append((Problem(name).plant, values, outcome))
        shown.append(
            {"problem": name, "plant": Problem(name).plant, "outcome": outcome}
            | dict(zip(FEATURES, values, strict=True))
        )
    if not data:
        return {"problems": 0}
    plants = np.array([plant for plant, _, _ in data])
    table = np.array([values for _, values, _ in data])
    outcome = np.array([value for _, _, value in data])
    correlations = {}
    for i, feature in enumerate(FEATURES):
        known = np.isfinite(table[:, i])
        varied = known.sum() > 2 and np.ptp(table[known, i]) > 0
        correlations[feature] = (
            float(spearmanr(table[known, i], outcome[known]).statistic) if varied else None
        )
    within = {
        feature: within_equal(table[:, 0], table[:, i], outcome)
        for i, feature in enumerate(FEATURES)
        if i > 0
    }
    right = 0
    usual = 0
    rules = list[str]()
    for plant in sorted(set(plants)):
        out = plants == plant
        rule = stump(table[~out], outcome[~out] < 0)
        rules.append(FEATURES[rule[0]])
        guess = (table[out, rule[0]] > rule[1]) == rule[2]
        right += int((guess == (outcome[out] < 0)).sum())
        usual += int(((outcome[out] < 0) == ((outcome[~out] < 0).mean() > 0.5)).sum())
    return {
        **how_far(table, outcome, plants),
        "problems": len(data),
        "search_nearer": int((outcome < 0).sum()),
        "correlations": correlations,
        "within": within,
        "right": right,
        "usual": usual,
        "rules": rules,
        "holds": right > usual,
        "one_basin": sum(row["best_basin"] >= 1.0 for row in shown),
        "with_basins": sum(bool(np.isfinite(row["best_basin"])) for row in shown),
        "strongest": strongest_of(correlations),
        "least_basin": float(np.nanmin([row["best_basin"] for row in shown])),
        "table": shown,
    }


def within_equal(groups: Array, feature: Array, outcome: Array) -> float | None:
    """Rank correlation among problems of one group, as of equal coefficients; of all groups.

    Ranks are those within a group, about its mean, as shares of its size.
    """
    pairs = list[Array]()
    for group in np.unique(groups):
        members = (groups == group) & np.isfinite(feature)
        size = int(members.sum())
        if size < 3:
            continue
        ranks = np.column_stack([rankdata(feature[members]), rankdata(outcome[members])])
        pairs.append((ranks - (size + 1) / 2) / size)
    if not pairs:
        return None
    first, second = np.vstack(pairs).T
    if not (first.any() and second.any()):
        return None
    return float(first @ second / np.sqrt((first @ first) * (second @ second)))


def strongest_of(correlations: Mapping[str, float | None]) -> list[str | float]:
    """The two features with the largest rank correlations, each with its own."""
    known = [(name, value) for name, value in correlations.items() if value is not None]
    known.sort(key=lambda pair: -abs(pair[1]))
    return [entry for pair in known[:2] for entry in pair]


def how_far(table: Array, outcome: Array, plants: NDArray[np.str_]) -> dict[str, Any]:
    """How well one feature predicts the outcome itself on plants that were left out.

    The feature with the largest rank correlation on the other plants, a straight line over its
    logarithm; explained is the share of the squared distances from the others' mean.
    """
    logarithms = np.log10(np.maximum(table, 1e-4))
    missed = 0.0
    total = 0.0
    chosen = list[str]()
    for plant in sorted(set(plants)):
        out = plants == plant
        strength = [
            abs(spearmanr(column[~out], outcome[~out]).statistic)
            if np.isfinite(column).all() and np.ptp(column[~out]) > 0
            else 0.0
            for column in logarithms.T
        ]
        best = int(np.argmax(strength))
        chosen.append(FEATURES[best])
        slope, level = np.polyfit(logarithms[~out, best], outcome[~out], 1)
        missed += float(np.sum((outcome[out] - level - slope * logarithms[out, best]) ** 2))
        total += float(np.sum((outcome[out] - outcome[~out].mean()) ** 2))
    return {"explained": 1 - missed / total, "by": chosen}


def stump(table: Array, wins: NDArray[np.bool_]) -> tuple[int, float, bool]:
    """The feature, threshold and side that tell wins most often."""
    best = (-1, 0, 0.0, True)
    for i in range(table.shape[1]):
        values = np.unique(table[np.isfinite(table[:, i]), i])
        for threshold in (values[1:] + values[:-1]) / 2:
            for side in (True, False):
                score = int((((table[:, i] > threshold) == side) == wins).sum())
                if score > best[0]:
                    best = (score, i, float(threshold), side)
    return best[1:]


def both(
    results: Results, problems: Sequence[str], searches: Sequence[tuple[str, int]]
) -> dict[str, list[dict[str, Any]]]:
    """Comparisons by either measure."""
    return {measure: compare(results, problems, searches, measure) for measure in MEASURES}


def efforts(results: Results) -> dict[str, Any]:
    """Runs, hours and seeds by axis, beside the runs of the plan."""
    with (results.folder / "plan.csv").open(newline="") as file:
        planned = list(csv.DictReader(file))
    runs = defaultdict[str, list[Run]](list)
    for run in results.runs:
        runs[run.axis].append(run)
    return {
        "plan": {row["axis"]: int(row["jobs"]) for row in planned},
        "plan_hours": {row["axis"]: float(row["hours"]) for row in planned},
        "runs": {axis: len(rows) for axis, rows in runs.items()},
        "hours": {axis: sum(run.seconds for run in rows) / 3600 for axis, rows in runs.items()},
        "seeds": {axis: 1 + max(run.seed for run in rows) for axis, rows in runs.items()},
        "problems": len(results.whole),
    }


def gradient_labels(results: Results, problems: Sequence[str]) -> list[tuple[str, int]]:
    """Methods without a budget that were run on most of the problems."""
    labels = {run.label for run in results.runs if run.axis == "centre" and not run.budget}
    return [
        (label, 0)
        for label in sorted(labels)
        if 2 * sum(bool(results.of(label, 0, name)) for name in problems) > len(problems)
    ]


def map_figures(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """Coefficients and budget crossed, and the lines through the centre."""
    over_terms = [(terms, terms, 10_000) for terms in TERMS]
    over_budgets = [(budget, CENTRE, budget) for budget in BUDGETS]
    return {
        "crossed": list(crossed),
        "map": [cell(results, terms, budget, crossed) for budget in BUDGETS for terms in TERMS],
        "map_rows": {
            "by_terms": lines_over(results, over_terms, crossed),
            "by_budget": lines_over(results, over_budgets, crossed),
        },
    }


def energy_by_terms(results: Results, crossed: Sequence[str]) -> dict[str, list[dict[str, float]]]:
    """Energy within 1 mm above that of the gradient with most coefficients, medians over moves [%].

    After 10,000 candidates; a run without such a motion counts as infinite.
    """
    most = {Problem(name).move: name for name in results.problems(TERMS[-1])}
    least = {move: runs[0].energy for move, name in most.items() if (runs := results.control(name))}
    control = f"{CONTROL} {CONTROL_SETTINGS}"
    figures = {}
    for method in (control, *crossed):
        budget = 0 if method == control else 10_000
        figures[method] = []
        for terms in TERMS:
            ratios = [
                np.median([run.energy if np.isfinite(run.energy) else np.inf for run in runs])
                / least[Problem(name).move]
                for name in results.problems(terms)
                if Problem(name).move in least and (runs := results.of(method, budget, name))
            ]
            above = 100 * (float(np.median(ratios)) - 1) if ratios else float("nan")
            figures[method].append({"terms": terms, "above": above, "moves": len(ratios)})
    return figures


def kind_figures(results: Results) -> dict[str, Any]:
    """By the kind of energy, on the moves that all kinds have, with motions between."""
    figures = {}
    moves = moves_with_other_kinds(results)
    for kind in KINDS:
        problems = [name for name in results.problems(kind=kind) if Problem(name).move in moves]
        methods = {run.label for run in results.runs if run.axis == "energy" and run.budget}
        searches = [
            (label, 10_000)
            for label in sorted(methods)
            if sum(bool(results.of(label, 10_000, name)) for name in problems) >= 8
        ]
        figures[kind] = compare(results, problems, searches, "between") if problems else []
    return figures


def moves_with_other_kinds(results: Results) -> set[str]:
    """The moves that were run with several kinds of energy."""
    return {Problem(name).move for name in results.whole if Problem(name).kind in KINDS[1:]}


def against_differences(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """By the kind of energy, the searches against differences with as many candidates.

    And at the centre against differences whose starts are random; and what differences lack where
    an integer is among the variables, by seed.
    """
    budget = 10_000
    moves = moves_with_other_kinds(results)
    by_kind = {}
    for kind in KINDS:
        problems = [name for name in results.problems(kind=kind) if Problem(name).move in moves]
        searches = [
            (label, budget)
            for label in crossed
            if not takes_slopes(label)
            and sum(bool(results.of(label, budget, name)) for name in problems) >= 8
        ]
        by_kind[kind] = compare(
            results,
            problems,
            searches,
            "between",
            by_label(results, DIFFERENCES, budget),
        )
    random = f"{DIFFERENCES} continuation=False"
    by_seed = defaultdict[int, list[float]](list)
    for name in results.problems(kind="integer"):
        for run in results.of(DIFFERENCES, budget, name):
            by_seed[run.seed].append(results.gap(run, "between"))
    return {
        "kinds": by_kind,
        "random_starts": compare(
            results,
            results.problems(),
            [("moead-de", budget)],
            "between",
            by_label(results, random, budget),
        ),
        "integer_by_seed": [float(np.median(values)) for _, values in sorted(by_seed.items())],
    }


def gain_of_coefficients(
    results: Results, crossed: Sequence[str], fewer: int = 10, more: int = 24
) -> dict[str, dict[str, int]]:
    """On how many moves a method's energy within 1 mm is less with more coefficients.

    After 10,000 candidates; beside it the moves on which it has no such motion with more of them.
    """
    figures = {}
    for method in crossed:
        energies = dict[int, dict[str, float]]()
        for terms in (fewer, more):
            runs_of = {name: results.of(method, 10_000, name) for name in results.problems(terms)}
            energies[terms] = {
                Problem(name).move: float(
                    np.median([run.energy if np.isfinite(run.energy) else np.inf for run in runs])
                )
                for name, runs in runs_of.items()
                if runs
            }
        moves = energies[fewer].keys() & energies[more].keys()
        figures[method] = {
            "moves": len(moves),
            "less": sum(energies[more][move] < energies[fewer][move] for move in moves),
            "none": sum(energies[more][move] == np.inf for move in moves),
        }
    return figures


def noise_figures(results: Results) -> dict[str, Any]:
    """By the share of the noise, on the moves that were run with noise, with motions between."""
    noisy = [run for run in results.runs if run.axis == "noise"]
    problems = sorted({run.problem for run in noisy})
    methods = sorted({run.method for run in noisy})
    figures = {"0": compare(results, problems, [(name, 10_000) for name in methods], "between")}
    for share in ("0.01", "0.05"):
        labels = sorted({run.label for run in noisy if run.label.endswith(f"noise={share}")})
        searches = [(label, 10_000) for label in labels]
        figures[share] = compare(results, problems, searches, "between") if searches else []
    return figures if noisy else {}


def objective_figures(results: Results) -> dict[str, Any]:
    """With three and four objectives, by points alone; and what the gradient's grid takes."""
    rows = {}
    seconds = {}
    for count in ("3", "4"):
        problems = results.problems(kind=f"absolute-{count}-objectives")
        searches = searches_in(results, ("objectives",), 10_000, problems, 5)
        grid = [("epsilon points=50", 0)] if searches else []
        rows[count] = compare(results, problems, [*searches, *grid], "points") if searches else []
        times = [run.seconds for name in problems for run in results.control(name)]
        seconds[count] = _median(np.array(times))
    return {"objectives": rows, "grid_seconds": seconds}


def million(results: Results) -> dict[str, list[dict[str, Any]]]:
    """What a million candidates leave, by coefficients, with motions between."""
    runs = [run for run in results.runs if run.axis == "million"]
    figures = {}
    for terms in sorted({Problem(run.problem).terms for run in runs}):
        of_terms = [run for run in runs if Problem(run.problem).terms == terms]
        problems = sorted({run.problem for run in of_terms})
        searches = sorted({(run.label, run.budget) for run in of_terms})
        figures[str(terms)] = compare(results, problems, searches, "between")
    return figures


def compute(folder: Path) -> dict[str, Any]:
    """All figures."""
    results = Results(folder)
    centre = results.problems()
    in_crossing = searches_in(results, ("crossing",), 10_000, results.problems(4), 5)
    crossed = [label for label, _ in in_crossing]
    central = searches_in(results, ("centre",), 10_000, centre, 10)
    methods = [*central, *gradient_labels(results, centre)]
    times = np.logspace(-2, 1.5, 36)
    paper = [
        pair
        for budget in (40_000, 100_000)
        for pair in searches_in(results, ("paper",), budget, centre, 5)
    ]
    landscapes = (folder / "landscapes.csv").exists()
    return {
        **efforts(results),
        **map_figures(results, crossed),
        **objective_figures(results),
        "energy_by_terms": energy_by_terms(results, crossed),
        "repeats": repeats(results),
        "beaten": beaten(results),
        "centre": both(results, centre, methods),
        "paper": both(results, centre, paper),
        "large": both(results, centre, searches_in(results, ("large",), 100_000, centre, 3)),
        "million": million(results),
        "tuned": tuned(results),
        "both_tuned": both_tuned(results),
        "kinds": kind_figures(results),
        "noise": noise_figures(results),
        "limits": limit_figures(results),
        "few": few_figures(results),
        "further": further_figures(results),
        "families": energy_of_families(results),
        "parallel": parallel_figures(results),
        "judged": judged_rows(results),
        "indicators": by_indicator(results, crossed),
        "differences": against_differences(results, crossed),
        "gain": gain_of_coefficients(results, crossed),
        "attained": {
            "seconds": times.tolist(),
            "shares": attained(results, centre, methods, times),
            "drawn": DRAWN,
        },
        "profiles": runtime_profiles(results),
        "black_box": black_box_figures(folder),
        "basins": basins_figures(folder),
        "prediction": {
            measure: prediction(results, 10_000, crossed, measure)
            for measure in MEASURES
            if landscapes
        },
    }


def differences(first: Any, second: Any, place: str = "") -> list[str]:
    """Where two documents differ by more than a relative 1e-6."""
    if isinstance(first, dict) and isinstance(second, dict) and first.keys() == second.keys():
        return [
            line for key in first for line in differences(first[key], second[key], f"{place}/{key}")
        ]
    if isinstance(first, list) and isinstance(second, list) and len(first) == len(second):
        pairs = enumerate(zip(first, second, strict=True))
        return [line for i, pair in pairs for line in differences(*pair, f"{place}/{i}")]
    if isinstance(first, float) and isinstance(second, float):
        same = np.isclose(first, second, rtol=1e-6, atol=1e-12, equal_nan=True)
    else:
        same = first == second
    return [] if same else [f"{place}: {first} and {second}"]


PAGES = ("report.md", "appendix.md")
OF_SIZE = re.compile(r"[\d.]+ MB in all")
"""Of the folder, which holds the page itself."""


def wrong_lines(folder: Path, figures: Mapping[str, Any]) -> list[str]:
    """Lines of the pages, and of choose.md, that are not those of the figures.

    ImportError where the templates, or quietarm, are missing.
    """
    benchmarks = Path(__file__).parents[2] / "benchmarks"
    sys.path.append(str(benchmarks))
    page = import_module("parts.crossover.page")
    filled = {name: page.page_of(name, figures, folder) for name in PAGES}
    lines = list[str]()
    for name, text in filled.items():
        lines += other_lines(name, (folder / name).read_text(), text)
    choose = folder.parent / "choose.md"
    if choose.exists():
        repeated, decision = map(page.decision_in, (choose.read_text(), filled[PAGES[0]]))
        lines += other_lines("the table of choose.md", repeated, decision)
    return lines


def other_lines(name: str, text: str, expected: str) -> list[str]:
    """Name the lines of a page that differ from what was expected, by their first other number."""
    rows = [OF_SIZE.sub("", page).splitlines() for page in (text, expected)]
    if len(rows[0]) != len(rows[1]):
        return [f"{name} has {len(rows[0])} lines, and the figures fill {len(rows[1])}"]
    lines = list[str]()
    for number, (row, of_figures) in enumerate(zip(*rows, strict=True), start=1):
        if row == of_figures:
            continue
        printed, known = (re.findall(r"-?\d[\d.,]*\d|-?\d", line) for line in (row, of_figures))
        pairs = [pair for pair in zip(printed, known, strict=False) if pair[0] != pair[1]]
        one, other = pairs[0] if pairs else (row, of_figures)
        lines.append(f"{name}, line {number}: {one} is printed, and the files give {other}")
    return lines


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare, or write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("folder", nargs="?", type=Path, default=Path(__file__).parent)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args(arguments)
    folder = options.folder
    figures = json.loads(json.dumps(compute(folder)))
    path = folder / "figures.json"
    if options.write:
        path.write_text(json.dumps(figures, indent=1) + "\n")
        return 0
    published = json.loads(path.read_text())
    lines = differences(published, figures)
    print("\n".join(lines[:20]) if lines else "all figures are those of figures.json")
    try:
        wrong = wrong_lines(folder, published)
    except ImportError as error:
        print(f"{' and '.join(PAGES)} are not compared: {error}; run this in a checkout")
        return int(bool(lines))
    print("\n".join(wrong) if wrong else f"{' and '.join(PAGES)} have these figures")
    return int(bool(lines or wrong))


if __name__ == "__main__":
    sys.exit(main())
