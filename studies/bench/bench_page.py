"""The report of a bench: tables, sentences and pictures."""

from __future__ import annotations

import platform
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.evaluation.population import ACCURACY
from quietarm.metaheuristics.score import GAP, HYPERVOLUME, Indicator, known_indicators
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.bench.bench_pictures import curves_figure, profiles_figure, ranks_figure
from quietarm.studies.bench.results import (
    ENERGIES,
    MISSING,
    Results,
    bench_label,
    column_of,
    derivative_free,
    quartiles,
)
from quietarm.studies.bench.statistics import (
    kruskal_on,
    moves_of,
    p_against_best,
    pairs_on,
    ranking_over,
    say_power_of,
    verdict_on,
)
from quietarm.views.report import Report
from quietarm.views.report.words import window_words

SHOWN_TARGET = 0.1
"""Share of the hypervolume missing to which tables give the expected running time."""
_ENERGY = "energy_1mm"
_MISSING_BETWEEN = f"{MISSING}_between"
_ENERGY_ABOVE = "energy above at 1 mm [%]"
_BETWEEN = "with motions between [%]"
"""What a run lacks with motions between its points."""
_STILL = f"within {1e3 * LEVELS[0]:g} mm"
"""How many runs have so small a residual."""
_P = "p"
"""Holm-adjusted p against the method of the smallest gap."""
_COST = ("evaluations", "gradients", "hessians", "seconds")


@interruptible
def bench_report(
    results: Results, line: str, template: str | Path = "studies/bench/report.md"
) -> Report:
    """The report of a bench that a line made.

    Every picture and table is worked out from the runs alone.
    """
    problems = [problem.name for problem in results.problems]
    moves = [problem.name for problem in results.moves]
    ranking = ranking_over(results)
    pairs = pd.concat(
        [
            pd.DataFrame(
                {"problem": name, "measure": measure} | dict(pairs_on(results, name, measure))
            )
            for name in problems
            for measure in compared_columns(of_move=name in moves)
        ],
        ignore_index=True,
    )
    of_problem = {name: problem_table(results, name) for name in problems}
    tables = {
        "summary": summary_table(results),
        "problems": pd.concat(of_problem, names=["problem", ""]).reset_index("problem"),
        "runs": _with_labels(results.table, "method"),
        "pairs": _with_labels(pairs, "one", "other"),
        "running_times": _with_labels(results.running_times, "method"),
    }
    figures: Any = {
        "curves.png": partial(curves_figure, results),
        "evaluations.png": partial(curves_figure, results, "evaluations"),
        "profiles.png": partial(profiles_figure, results),
    }
    counted = any(map(derivative_free, results.methods))
    if counted:
        figures["profiles_candidates.png"] = partial(profiles_figure, results, "evaluations")
    if ranking is not None:
        ranks = pd.DataFrame({"method": ranking.methods, "mean rank": ranking.ranks})
        tables["ranks"] = _with_labels(ranks, "method")
        figures["ranks.png"] = partial(ranks_figure, ranking)
    versions = results.runs[0].front.record.versions
    values = {
        "line": line,
        "counted": counted,
        "problems": problems,
        "of_problem": of_problem,
        "methods": [bench_label(m) for m in results.methods],
        "power": say_power_of((run.problem.name, run.method) for run in results.runs),
        "ranking": ranking,
        "label_of": bench_label,
        "accuracy": ACCURACY,
        "noisy": any("noise" in run.front.record.settings for run in results.runs),
        "indicators": known_indicators(),
        "target": f"{100 * SHOWN_TARGET:g}",
        "moves": len(moves_of(results.problems)),
        "functions": [name for name in problems if name not in moves],
        "verdicts": {name: verdict_on(results, name) for name in problems},
        "by_indicator": {
            name: {
                indicator.label: verdict_on(results, name, column_of(indicator))
                for indicator in _others()
            }
            for name in problems
        },
        "on_energy": {name: verdict_on(results, name, _ENERGY) for name in moves},
        "windows": _windows(results),
        "energy_ranking": ranking_over(results, _ENERGY),
        "kruskal": {name: kruskal_on(results, name) for name in problems},
        "repeated": _repeated(results),
        "copies": [run.label for run in results.copies],
        "imported": results.imported,
        "machine": f"{platform.machine()}, {platform.system()}",
        "versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
    }
    return Report(template, values, tables, figures)


def compared_columns(*, of_move: bool = True) -> list[str]:
    """Columns of the runs that pairs of methods are tested on: every indicator, and the energy.

    The energy is of moves alone.
    """
    return [*map(column_of, known_indicators().values()), *([_ENERGY] if of_move else [])]


def _others() -> list[Indicator]:
    """The indicators beside the hypervolume, which ranks methods and has a column of its own."""
    return [indicator for indicator in known_indicators().values() if indicator is not HYPERVOLUME]


def _heading(indicator: Indicator) -> str:
    return f"{indicator.label} [{indicator.unit}]" if indicator.unit else indicator.label


def _medians(table: Any) -> dict[str, float]:
    """Medians over runs of the indicators beside the hypervolume, by their headings."""
    factor = {"%": 100.0}
    return {
        _heading(indicator): factor.get(indicator.unit, 1.0)
        * quartiles(table[column_of(indicator)])[1]
        for indicator in _others()
    }


def reported_runs(folder: Path) -> pd.DataFrame | None:
    """The table of runs beside a report that is in a folder; None where there is no report.

    ValueError where it is no table of a bench.
    """
    path = folder / "runs.csv"
    if not ((folder / "report.md").exists() and path.exists()):
        return None
    try:
        return _identities(pd.read_csv(path))
    except (OSError, ValueError, KeyError, TypeError):
        raise ValueError(f"{path} is no table of a bench; give another folder") from None


def not_reported_again(results: Results, reported: pd.DataFrame | None) -> int:
    """Count the runs of an earlier report that a report of these results would lose.

    The arguments are the results and what `reported_runs` gave.
    """
    if reported is None:
        return 0
    now = _identities(_with_labels(results.table, "method"))
    return len(set(reported.itertuples(index=False)) - set(now.itertuples(index=False)))


def _identities(table: pd.DataFrame) -> pd.DataFrame:
    """Return what tells the runs of a table apart; the gradient's candidates are no budget."""
    by_candidates = table["gradients"] == 0
    return pd.DataFrame(
        {
            "problem": table["problem"].astype(str),
            "method": table["method"].astype(str),
            "seed": table["seed"].fillna(-1).astype(int),
            "budget": table["evaluations"].where(by_candidates, -1).astype(int),
        }
    )


def _with_labels(table: pd.DataFrame, *columns: str) -> pd.DataFrame:
    """A table whose columns name methods, as these are called."""
    return table.assign(**{name: table[name].map(bench_label) for name in columns})


def brief_report(results: Results) -> Report:
    """Return the report for a terminal: a narrow table and a verdict for each problem."""
    columns = ["method", "runs", GAP, _P, _STILL, "seconds"]
    names = [problem.name for problem in results.problems]
    tables: dict[str, Any] = {
        name: problem_table(results, name).filter(columns).map(_rounded) for name in names
    }
    verdicts = {name: verdict_on(results, name) for name in names}
    values = {
        "verdicts": verdicts,
        "repeated": _repeated(results),
        "copies": [run.label for run in results.copies],
        "windows": _windows(results),
    }
    return Report("studies/bench/brief.md", values, tables, answer=answer_of_bench(results))


def answer_of_bench(results: Results) -> str:
    """Return who has the smallest hypervolume gap, and by how much, in a sentence."""
    (only, *others) = [problem.name for problem in results.problems]
    table = summary_table(results) if others else problem_table(results, only)
    first, *rest = zip(table["method"], table[GAP])
    where = f"over {len(others) + 1} problems" if others else f"on {only}"
    words = f"{first[0]} is best {where}: its hypervolume gap is {_gap_words(first[1])}"
    if rest:
        words += f"; {rest[0][0]} is next with {_gap_words(rest[0][1])}"
    return f"{words}."


def _gap_words(gap: float) -> str:
    return f"{gap:.3g} %" if np.isfinite(gap) else "unknown"


def _windows(results: Results) -> str:
    """Residual windows of the moves; of which, where they differ; empty without a move."""
    names: dict[str, list[str]] = {}
    for problem in results.moves:
        names.setdefault(window_words(problem.task.residual_window), []).append(problem.name)
    if len(names) == 1:
        return next(iter(names))
    return ", ".join(f"{words} ({', '.join(of)})" for words, of in names.items())


def _repeated(results: Results) -> dict[str, list[str]]:
    """Return by problem the methods that found the same from every seed."""
    return {
        problem.name: [
            bench_label(m) for m in results.methods if results.is_repeated(problem.name, m)
        ]
        for problem in results.problems
    }


def _rounded(cell: Any) -> Any:
    if not isinstance(cell, float):
        return cell
    return f"{cell:.3g}" if np.isfinite(cell) else "-"


def problem_table(results: Results, problem: str) -> pd.DataFrame:
    """Medians over the runs of every method on a problem, best first."""
    rows = []
    table = results.table[results.table["problem"] == problem]
    p_values = p_against_best(results, problem)
    is_move = any(problem == move.name for move in results.moves)
    for method, runs in table.groupby("method"):
        low, middle, high = (100 * share for share in quartiles(runs[MISSING]))
        time = results.expected_running_time(problem, str(method), SHOWN_TARGET)
        spent = {name: quartiles(runs[name])[1] for name in _COST}
        rows.append(
            {
                "method": bench_label(str(method)),
                "runs": len(runs),
                GAP: middle,
                "quartiles [%]": f"{low:.3g} to {high:.3g}",
                _P: p_values.get(str(method)),
                **({_BETWEEN: 100 * quartiles(runs[_MISSING_BETWEEN])[1]} if is_move else {}),
                **_medians(runs),
                **(_energies_of(runs) if is_move else {}),
                f"to {100 * SHOWN_TARGET:g} % [s]": interval_words(*time),
                "candidates": spent["evaluations"],
                "gradients": spent["gradients"],
                "Hessians": spent["hessians"],
                "seconds": spent["seconds"],
            }
        )
    return _best_first(rows)


def _energies_of(runs: Any) -> dict[str, Any]:
    """The median energy of runs on a move, and how many came to rest, by headings."""
    still = np.isfinite(np.asarray(runs[ENERGIES[0]], dtype=float))
    return {
        _ENERGY_ABOVE: 100 * quartiles(runs[_ENERGY])[1],
        _STILL: f"{np.count_nonzero(still)} of {len(runs)}",
    }


def interval_words(value: float, low: float, high: float) -> str | None:
    """A value and its interval; None where it is infinite."""
    ends = f"{low:.3g} to {high:.3g}" if np.isfinite(high) else f"from {low:.3g}"
    return f"{value:.3g} ({ends})" if np.isfinite(value) else None


def summary_table(results: Results) -> pd.DataFrame:
    """Every method over all problems: medians over problems of the medians over runs.

    Of motions between points and of energies the moves count alone, and no functions.
    """
    rows = []
    moves = [move.name for move in results.moves]
    for method, runs in results.table.groupby("method"):
        medians = _medians_by_problem(runs, [*map(column_of, known_indicators().values()), *_COST])
        over = {name: quartiles(medians[name])[1] for name in medians}
        on_moves = runs[runs["problem"].isin(moves)]
        rows.append(
            {
                "method": bench_label(str(method)),
                "problems": len(medians),
                "runs": len(runs),
                GAP: 100 * over[MISSING],
                **(_between_over(on_moves) if moves else {}),
                **_medians(medians),
                **(_energies_over(on_moves) if moves else {}),
                "candidates": over["evaluations"],
                "gradients": over["gradients"],
                "seconds": over["seconds"],
            }
        )
    return _best_first(rows)


def _medians_by_problem(runs: Any, columns: list[str]) -> Any:
    """The medians over the runs on each problem, a row a problem."""
    return runs.groupby("problem")[columns].agg(lambda column: quartiles(column)[1])


def _between_over(runs: Any) -> dict[str, float]:
    """Return what runs on moves lack with motions between their points, by its heading."""
    medians = _medians_by_problem(runs, [_MISSING_BETWEEN])[_MISSING_BETWEEN]
    return {_BETWEEN: 100 * quartiles(medians)[1]}


def _energies_over(runs: Any) -> dict[str, float]:
    """The energy of runs on several moves, and the share that came to rest, by headings."""
    still = np.isfinite(np.asarray(runs[ENERGIES[0]], dtype=float))
    return {
        _ENERGY_ABOVE: 100 * quartiles(_medians_by_problem(runs, [_ENERGY])[_ENERGY])[1],
        f"{_STILL} [%]": 100 * float(np.mean(still)) if len(still) else np.nan,
    }


def _best_first(rows: list[dict[str, Any]]) -> pd.DataFrame:
    return pd.DataFrame(rows).sort_values(GAP, ignore_index=True).replace(np.inf, np.nan)
