"""Results of `benchmarks/ten_robots.py`, and the tables that the page of evidence shows of them."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

COLUMNS = (
    "robot", "held_out", "motion", "duration_s", "residual_mm", "energy_j", "torque_share",
    "torque_joint", "torque_peak", "speed_share", "acceleration_share", "jerk_share", "stated_mm",
    "stated_j", "in_full_mm", "in_full_j", "refused",
)  # fmt: skip
RIVALS = ("cycloid", "ruckig", "toppra", "zvd")
PLAN, IN_FULL = "plan", "plan, in full"
SHARES = ("torque_share", "speed_share", "acceleration_share", "jerk_share")
NO_JERK = "toppra"
"""It knows no limit of the jerk, so that its share says nothing."""
OVER = 1.005
"""Share of a limit from which a motion is said to pass it."""
Rows = dict[str, dict[str, dict[str, str]]]


def read(results: Path) -> Rows:
    """Return the rows by robot and motion."""
    rows: Rows = {}
    with results.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            rows.setdefault(row["robot"], {})[row["motion"]] = row
    return rows


def tables(results: Path) -> dict[str, str]:
    """Return the tables by their names on the page: of all motions, and of what was stated."""
    rows = read(results)
    parts = [
        ("residual [mm]", "residual_mm"),
        ("energy [J]", "energy_j"),
        ("peak torque, share of its limit [%]", "torque_share"),
    ]
    of_figures = ("\n".join(_of_figure(rows, *part)) for part in parts)
    return {"robots": "\n\n".join(of_figures), "stated": "\n".join(_against_stated(rows))}


def with_tables(page: str, results: Path) -> str:
    """Return a page whose tables are those of the results."""
    for name, table in tables(results).items():
        begin, end = f"<!-- {name} -->\n", f"<!-- /{name} -->"
        before, rest = page.split(begin)
        _, after = rest.split(end)
        page = f"{before}{begin}\n{table}\n\n{end}{after}"
    return page


def _of_figure(rows: Rows, heading: str, column: str) -> Iterator[str]:
    """One line for each robot; a motion that passes a limit has a star."""
    yield f"| {heading} | time [s] | plan | plain cycloid | ruckig | toppra | ZVD |"
    yield "|---|---:|---:|---:|---:|---:|---:|"
    for name, motions in rows.items():
        best = motions.get(IN_FULL, motions[PLAN])
        shown = [best, *(motions.get(rival) for rival in RIVALS)]
        cells = [_cell(row, column) if row else "not run" for row in shown]
        held_out = " (held out)" if best["held_out"] == "True" else ""
        yield f"| {name}{held_out} | {best['duration_s']} | {' | '.join(cells)} |"


def _cell(row: dict[str, str], column: str) -> str:
    if row["refused"]:
        return "none"
    star = "*" if passes_limit(row) else ""
    value = float(row[column])
    if column == "torque_share":
        return f"{100 * value:.0f}{star}"
    return f"{row[column]}{star}" if value >= 1e-3 else f"{value:.4f}{star}"


def passes_limit(row: dict[str, str]) -> bool:
    """Return whether a motion passes a limit that it is asked to keep."""
    shares = [name for name in SHARES if not (name == "jerk_share" and row["motion"] == NO_JERK)]
    return any(float(row[name]) > OVER for name in shares)


def _against_stated(rows: Rows) -> Iterator[str]:
    """Say what quietarm states of the plans, beside MuJoCo."""
    yield (
        "| plan | residual by the modes [mm] | in full | MuJoCo | "
        "energy by the modes [J] | in full | MuJoCo |"
    )
    yield "|---|---:|---:|---:|---:|---:|---:|"
    for name, motions in rows.items():
        for kind in (PLAN, IN_FULL):
            if kind in motions:
                row = motions[kind]
                label = f"{name}, `--in-full`" if kind == IN_FULL else name
                cells = [f"{float(row['stated_mm']):.3f}", _short(row["in_full_mm"])]
                cells += [_short(row["residual_mm"]), row["stated_j"]]
                cells += [row["in_full_j"] or "-", row["energy_j"]]
                yield f"| {label} | {' | '.join(cells)} |"


def _short(millimetres: str) -> str:
    return millimetres if float(millimetres) >= 1e-3 else f"{float(millimetres):.4f}"
