"""Write docs/results from the files beside it, and the decision that docs/choose.md repeats."""

from __future__ import annotations

import importlib.util
import json
import platform
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from .pictures import WAYS, write_pictures
from .plan import LADDER
from .run import plan_table
from .tables import write_table
from .verdicts import verdicts
from .words import short_label, signed, spelled_budget, two_digits, without_noise

BEGIN = "<!-- what to take: benchmarks/crossover.py writes these lines -->"
END = "<!-- end of what to take -->"
SLOPES = ("epsilon", "multistart", "memetic", "+polish", "slsqp")
"""What takes derivatives or differences, by name."""


def write_page(results: Path, choose: Path | None = None) -> None:
    """Plan, figures, pictures, page, and the lines of docs/choose.md."""
    write_plan(results)
    figures = recomputed(results)
    (results / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")
    write_pictures(figures, results)
    (results / "appendix.md").write_text(page_of("appendix.md", figures, results))
    text = page_of("report.md", figures, results)
    (results / "report.md").write_text(text)
    choose = choose or results.parent / "choose.md"
    if choose.exists():
        choose.write_text(with_decision(choose.read_text(), decision_in(text)))


def write_plan(results: Path) -> None:
    """Write a table of how many jobs every axis has in all, and their hours."""
    write_table(plan_table(results).drop(columns="done"), results / "plan.csv", 3)


def recomputed(results: Path) -> dict[str, Any]:
    """All figures, by the script that is published beside them."""
    return json.loads(json.dumps(recompute_module(results).compute(results)))


def recompute_module(results: Path) -> Any:
    """The published script as a module."""
    source = Path(__file__).parents[3] / "docs" / "results" / "recompute.py"
    spec = importlib.util.spec_from_file_location("recompute", source)
    if spec is None or spec.loader is None:
        raise FileNotFoundError(source)
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules["recompute"] = module
    spec.loader.exec_module(module)
    return module


def page_of(template: str, figures: Mapping[str, Any], results: Path) -> str:
    """Return a page in Markdown, filled in from the figures."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(
        short=short_label,
        budget=spelled_budget,
        two=two_digits,
        p=p_value,
        times=times_of,
        signed=signed,
        without_noise=without_noise,
    )
    moves = pd.read_csv(results / "moves.csv")
    return environment.get_template(template).render(
        figures=figures,
        moves=moves,
        plants=moves["plant"].unique().tolist(),
        takes_slopes=takes_slopes,
        nearest=nearest,
        verdicts=verdicts,
        cell_of=cell_of,
        best_of=best_of,
        limits_over=limits_over,
        gaussian_words=gaussian_words,
        seed_words=seed_words,
        ladder=LADDER,
        ways=WAYS,
        row_of=row_of,
        begin=BEGIN,
        end=END,
        machine=f"Python {platform.python_version()}",
        megabytes=sum(path.stat().st_size for path in results.rglob("*") if path.is_file()) / 1e6,
    )


def takes_slopes(method: str) -> bool:
    """Return whether a method takes derivatives or differences, in whole or in part."""
    return any(word in method for word in SLOPES)


def nearest(rows: Sequence[Mapping[str, Any]]) -> Mapping[str, Any]:
    """The search that misses least: of what takes neither derivatives nor differences."""
    return min(
        (row for row in rows if not takes_slopes(row["method"])),
        key=lambda row: row["missing"],
    )


def best_of(rows: Sequence[Mapping[str, Any]], method: str) -> Mapping[str, Any]:
    """The row of a method with those of its settings that miss least."""
    return min(
        (row for row in rows if row["method"].partition(" ")[0] == method),
        key=lambda row: row["missing"],
    )


def cell_of(cells: Sequence[Mapping[str, Any]], terms: int, budget: int) -> Mapping[str, Any]:
    """The comparisons of a cell of the map."""
    return next(
        cell["ways"] for cell in cells if (cell["terms"], cell["budget"]) == (terms, budget)
    )


def limits_over(limits: Mapping[str, Any], budget: int) -> dict[str, Any] | None:
    """Return what the row with limits says: ranges over the kinds of limit; None before any run.

    The search is the one whose largest gap over the kinds is least.
    """
    kinds = [kind for kind in limits.values() if kind["budget"] == budget]
    if not kinds:
        return None
    labels = [row["method"] for row in kinds[0]["differences"]]
    rows = {
        label: [row for kind in kinds for row in kind["differences"] if row["method"] == label]
        for label in labels
    }
    label = min(
        (label for label in labels if len(rows[label]) == len(kinds)),
        key=lambda label: max(row["missing"] for row in rows[label]),
    )
    chosen = rows[label]
    gradient = [row_of(kind["methods"], label) or {} for kind in kinds]
    clear = [
        kind["limits"].replace("-", ", ")
        for kind, row in zip(kinds, chosen, strict=True)
        if row["holm"] <= 0.05 and row["log_ratio"] < 0
    ]
    better = sum(row["moves_nearer"] for row in chosen)
    compared = sum(row["moves"] - row["no_control"] for row in chosen)
    return {
        "kinds": len(kinds),
        "name": label.partition(" ")[0],
        "label": short_label(label),
        "search": range_of(row["missing"] for row in chosen),
        "differences": range_of(row["control"] for row in chosen),
        "gradient": range_of(row["control"] for row in gradient),
        "clear": len(clear),
        "is_sure": 2 * len(clear) >= len(kinds),
        "sure": (
            f"better than SLSQP on {better} of {compared} problems; "
            f"significant for {' and for '.join(clear) if clear else 'no kind of limit'}"
        ),
    }


def gaussian_words(figures: Mapping[str, Any]) -> str:
    """Say with what Gaussian processes were not run."""
    kinds = {kind["limits"] for kind in figures["limits"].values()}
    lacking = list[str]()
    for budget in (200, 1_000):
        run = [
            kind["limits"]
            for kind in figures["limits"].values()
            if kind["budget"] == budget and row_of(kind["methods"], "gp")
        ]
        only = f" (but for {' and '.join(run)})".replace("-", ", ") if run else ""
        if len(run) < len(kinds):
            lacking.append(f"with limits and {spelled_budget(budget)} candidates{only}")
    alone = {cell["budget"] for cell in figures["few"] if row_of(cell["methods"], "gp")}
    if 1_000 not in alone:
        lacking.append("with 1,000 candidates without limits")
    if not lacking:
        return "Gaussian processes were not run with more than 1,000 candidates."
    return f"Gaussian processes were not run {', nor '.join(lacking)}."


def seed_words(count: int) -> str:
    """Say how many seeds rows have, of which some have one."""
    return "1" if count <= 1 else f"1 to {count}"


def range_of(values: Iterable[float]) -> str:
    """The least and the largest value, with two digits."""
    known = sorted(values)
    return f"{two_digits(known[0])} to {two_digits(known[-1])}"


def row_of(rows: Sequence[Mapping[str, Any]], method: str) -> Mapping[str, Any] | None:
    """A method's row."""
    return next((row for row in rows if row["method"] == method), None)


def p_value(value: float | None) -> str:
    """A p value as it is printed."""
    if value is None or value != value:
        return "-"
    return f"{value:.2g}" if value >= 1e-4 else "< 0.0001"


def times_of(log_ratio: float) -> str:
    """A decimal logarithm as a factor."""
    return two_digits(10**log_ratio)


def decision_in(page: str) -> str:
    """The lines between the marks."""
    lines = re.search(f"{re.escape(BEGIN)}\n(.*?){re.escape(END)}", page, re.DOTALL)
    if lines is None:
        raise ValueError("the page has no decision between its marks")
    return lines.group(1)


def with_decision(text: str, decision: str) -> str:
    """A text with other lines between the marks."""
    if BEGIN not in text:
        raise ValueError("choose.md has no marks of what to take")
    head, _, rest = text.partition(BEGIN)
    _, _, tail = rest.partition(END)
    return f"{head}{BEGIN}\n{decision}{END}{tail}"
