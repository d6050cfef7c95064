"""Write docs/results from the files beside it, and the decision that docs/choose.md repeats."""

from __future__ import annotations

import importlib.util
import json
import platform
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from .deciding import DECIDING
from .first_table import (
    INDICATORS,
    TITLES,
    by_indicators,
    first_table,
    indicator_words,
    kind_of,
    least_p,
    seeds_of,
)
from .pictures import WAYS, write_pictures
from .plan import LADDER
from .run import plan_table
from .tables import write_table
from .verdicts import verdicts
from .words import (
    bold,
    capitalised,
    p_value,
    short_label,
    signed,
    spelled_budget,
    thousands,
    two_digits,
    without_noise,
)

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
        capitalised=capitalised,
        thousands=thousands,
        bold=bold,
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
        first_table=first_table,
        judged_indicators=by_indicators,
        indicator_words=indicator_words,
        indicator_names=INDICATORS,
        row_titles=TITLES,
        fresh_seeds=seeds_of,
        least_p=least_p,
        kind_of=kind_of,
        deciding=list(DECIDING),
        ladder=LADDER,
        ways=WAYS,
        row_of=row_of,
        begin=BEGIN,
        end=END,
        machine=f"Python {platform.python_version()}",
        megabytes=megabytes_of(results),
    )


def megabytes_of(results: Path) -> float:
    """Size of what is published; Python's own copies of its script are not."""
    files = [path for path in results.rglob("*") if path.is_file()]
    return sum(path.stat().st_size for path in files if "__pycache__" not in path.parts) / 1e6


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


def row_of(rows: Sequence[Mapping[str, Any]], method: str) -> Mapping[str, Any] | None:
    """A method's row."""
    return next((row for row in rows if row["method"] == method), None)


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
