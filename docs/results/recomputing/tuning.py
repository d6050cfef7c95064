"""Tuned settings beside those by default, on the moves of testing."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .comparing import searches_in
from .experiment import DIFFERENCES
from .first_table import ROWS, Row, chosen_on_first, judged, problems_of
from .gaps import MEASURES, Results
from .runs import Problem, rows_of
from .significance import add_holm, signed_ranks


def tuned(results: Results, folder: Path) -> list[dict[str, Any]]:
    """Default and tuned settings by cell and method on the moves of testing, and what was tried.

    Holm's p is over all methods of all cells.
    """
    figures = list[dict[str, Any]]()
    for (cell, method), tried in trials_of(folder).items():
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
        add_holm([row[measure] for row in figures if measure in row])
    return figures


def both_tuned(results: Results, folder: Path) -> list[dict[str, Any]]:
    """Every search against SLSQP in its cell, both with default settings and both tuned.

    Holm's p is over all of these with default settings, and over all of them tuned.
    """
    figures = list[dict[str, Any]]()
    label_of = {
        (cell, method): label_of_best(results, row_of_cell(cell), method, tried)
        for (cell, method), tried in trials_of(folder).items()
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
        add_holm([row[name] for row in figures])
    return figures


def trials_of(folder: Path) -> dict[tuple[str, str], list[dict[str, str]]]:
    """The trials by cell and method, cells in the order of the first table's rows."""
    trials = defaultdict[tuple[str, str], list[dict[str, str]]](list)
    for trial in rows_of(folder / "tuning.csv"):
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
    by_kind = problems_of(results, row)
    problems = [name for names in by_kind.values() for name in names]
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, problems, 5)
        if label.partition(" ")[0] == method
        and "continuation" not in label
        and ("noise=" in label) == bool(row.noise)
        and label.endswith(row.noise)
    ]
    return chosen_on_first(results, row, labels, by_kind)


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
        results.median_gaps([results.of(label, row.budget, name) for name in problems], measure)
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
