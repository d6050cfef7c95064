"""Jobs of a bench: memory of a search, what a job costs beyond its search, and two workers.

    python benchmarks/jobs.py [memory] [overhead] [workers] [--methods NAME,NAME,...]

- memory: peak of a process that searches a move by 100,000 candidates and saves the front, for each
  method of `quietarm list methods`.
- overhead: processor time of ten jobs of one worker over that of their searches. The search is all
  until its last candidate; the judging of its points by CVODES is told apart.
- workers: wall time of the same jobs by one worker over that by two, once all is loaded. It needs
  two idle cores.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from parts.measuring import console, machine
from rich.table import Table

from quietarm.metaheuristics import PRESETS, Job, run_jobs

QUIETARM = str(Path(sys.executable).parent / "quietarm")
MOVE = "single-link --target 90deg --duration 1 --bound 0.2"
PROBLEM = "single-link-90deg-1s"
MOST_MEMORY = 500.0
"""Of a search by 100,000 candidates [MB]."""
MOST_OVERHEAD = 0.05
"""Of a job beyond its search and the judging of its points, as a share of the search."""
LEAST_SPEEDUP = 1.8
"""Of two workers."""


def met(holds: bool) -> str:
    return "met" if holds else "missed"


def memory(methods: Sequence[str]) -> Table:
    """Peak memory and processor time of whole searches."""
    candidates = 100_000
    table = Table(title=f"{candidates:,} candidates, at most {MOST_MEMORY:g} MB")
    for heading in ("method", "peak [MB]", "processor [s]", ""):
        table.add_column(heading, justify="left" if heading == "method" else "right")
    with tempfile.TemporaryDirectory() as folder:
        for method in methods:
            preset = PRESETS[method]
            generations = candidates // preset.evaluations(preset.population, 1)
            line = f"search {MOVE} --method {method} --generations {generations} --quiet"
            output = Path(folder, f"{method}.json")
            command = [QUIETARM, *line.split(), "--output", str(output)]
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            if status:
                raise SystemExit(f"{method} ended with {status}")
            peak = usage.ru_maxrss / 1e3  # kB of Linux
            seconds = usage.ru_utime + usage.ru_stime
            row = method, f"{peak:.0f}", f"{seconds:.1f}", met(peak < MOST_MEMORY)
            table.add_row(*row)
            print(*row, flush=True)
    return table


def jobs_of(method: str, budget: int, seeds: int) -> list[Job]:
    return [Job(PROBLEM, method, seed, budget) for seed in range(seeds)]


def overhead(methods: Sequence[str]) -> Table:
    """Processor time of jobs over that of their searches."""
    seeds = 5
    table = Table(title=f"jobs beyond their searches, at most {MOST_OVERHEAD:.0%}")
    for heading in ("method", "candidates", "search [s]", "judging", "beyond both", ""):
        table.add_column(heading, justify="left" if heading == "method" else "right")
    for method in methods:
        for budget in (10_000, 100_000):
            jobs = jobs_of(method, budget, seeds)
            with tempfile.TemporaryDirectory() as folder:
                run_jobs(jobs_of(method, budget, 1), Path(folder, "first"))  # what is loaded first
                began = time.process_time()
                fronts = run_jobs(jobs, folder).values()
                whole = time.process_time() - began
            searched = sum(front.history[-1].seconds for front in fronts)
            judging = sum(front.record.seconds for front in fronts) - searched
            beyond = (whole - searched - judging) / searched
            table.add_row(
                method,
                f"{budget:,}",
                f"{searched / seeds:.2f}",
                f"{judging / searched:.1%}",
                f"{beyond:.1%}",
                met(beyond <= MOST_OVERHEAD),
            )
    return table


def workers(methods: Sequence[str]) -> Table:
    """Wall time by one worker over that by two."""
    budget = 20_000
    seeds = 8
    table = Table(title=f"two workers, at least {LEAST_SPEEDUP:g} times one")
    for heading in ("method", "one [s]", "two [s]", "ratio", ""):
        table.add_column(heading, justify="left" if heading == "method" else "right")
    for method in methods:
        walls = list[float]()
        for number in (1, 2):
            jobs = jobs_of(method, budget, seeds)
            with tempfile.TemporaryDirectory() as folder:
                run_jobs(jobs_of(method, budget, 2 * number), Path(folder, "first"), workers=number)
                began = time.perf_counter()
                run_jobs(jobs, folder, workers=number)
                walls.append(time.perf_counter() - began)
        ratio = float(np.divide(*walls))
        shown = [f"{wall:.2f}" for wall in walls]
        table.add_row(method, *shown, f"{ratio:.2f}", met(ratio >= LEAST_SPEEDUP))
    return table


def main() -> None:
    """Print a table for each part."""
    parts = {"memory": memory, "overhead": overhead, "workers": workers}
    usual = {"memory": list(PRESETS), "overhead": ["nsga2", "moead-de"], "workers": ["moead-de"]}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", default=list(parts), help=", ".join(parts))
    parser.add_argument("--methods", type=lambda text: text.split(","))
    arguments = parser.parse_args()
    if unknown := set(arguments.parts) - parts.keys():
        parser.error(f"no part {', '.join(unknown)}; give some of {', '.join(parts)}")
    output = console()
    output.print(machine("numpy", "pymoo"))
    for part in arguments.parts:
        output.print(parts[part](arguments.methods or usual[part]))


if __name__ == "__main__":
    main()
