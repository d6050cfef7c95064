"""What is published, figures.json and the pages, beside the figures of the files."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

PAGES = ("report.md", "appendix.md")
OF_SIZE = re.compile(r"[\d.]+ MB in all")
"""Of the folder, which holds the page itself."""


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


def wrong_lines(folder: Path, figures: Mapping[str, Any]) -> list[str]:
    """Lines of the pages, and of choose.md, that are not those of the figures.

    ImportError where the templates, or quietarm, are missing.
    """
    benchmarks = Path(__file__).parents[3] / "benchmarks"
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
