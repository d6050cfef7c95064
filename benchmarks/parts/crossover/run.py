"""Run the plan in batches, and pack what is finished."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path

import pandas as pd

import quietarm as qa
from quietarm.metaheuristics import Job, LostJobsError, run_jobs

from .deciding import Deciding
from .integers import front_of_every_number, search_of_every_number
from .landscape import add_features
from .packed import Row, key_of, read_rows, row_of, write_rows
from .plan import AXES, Planned, first_of_plants, rounds
from .problems import CENTRE_TERMS, read_moves
from .tables import best_settings, write_table

BATCH = 20
"""Jobs between two writings of the tables, and fronts in memory at once."""


def runs_path(results: Path, axis: str) -> Path:
    """The table of an axis."""
    return results / "runs" / f"{axis}.csv.xz"


def plan_of(results: Path) -> list[Planned]:
    """Every job of the plan, in order."""
    settings = best_settings(results / "tuning.csv")
    return list(rounds(read_moves(results / "moves.csv"), settings))


def done_keys(results: Path) -> set[tuple[str, str, str, str, int]]:
    """Keys of all runs that tables have."""
    return {key_of(row) for row in all_rows(results)}


def part_of(text: str) -> tuple[int, int]:
    """A part as it is typed, such as 2/4; ValueError where it is none."""
    number, _, count = text.partition("/")
    if not (number.isdigit() and count.isdigit() and 1 <= int(number) <= int(count)):
        raise ValueError(f"part is {text!r}; give a number of how many, such as 2/4")
    return int(number), int(count)


def refuse_axes(axes: Sequence[str]) -> None:
    """Refuse an axis that is not of the plan."""
    for axis in axes:
        if axis not in AXES:
            raise ValueError(f"no axis is called {axis!r}; give one of {', '.join(AXES)}")


def merge(results: Path, added: Path) -> None:
    """Add the rows and scales of further results, as of another part."""
    for path in sorted((added / "runs").glob("*.csv.xz")):
        table = results / "runs" / path.name
        rows = {key_of(row): row for row in [*read_rows(path), *read_rows(table)]}
        write_rows(rows.values(), table)
    scales = pd.concat([pd.read_csv(folder / "scales.csv") for folder in (results, added)])
    scales = scales.drop_duplicates("problem").sort_values("problem")
    write_table(scales, results / "scales.csv", 10)


def missing_of(
    results: Path,
    part: tuple[int, int] = (1, 1),
    axes: Sequence[str] = (),
    seeds: range | None = None,
    methods: Sequence[str] = (),
    candidates: Sequence[int] = (),
    of_plant: int | None = None,
    deciding: Sequence[Deciding] | None = None,
) -> list[Planned]:
    """Return what is to be run still, of the axes, seeds, methods and budgets that are given.

    And on so many moves of each plant, and of the report's rows that are given.
    """
    plan = plan_of(results)
    tested = [move for move in read_moves(results / "moves.csv") if not move.tuning]
    moves = {move.name for move in first_of_plants(tested, of_plant or len(tested))}
    done = done_keys(results)
    of_part = plan[part[0] - 1 :: part[1]]
    return [
        planned
        for planned in of_part
        if planned.key not in done
        and (not axes or planned.axis in axes)
        and (seeds is None or planned.round in seeds)
        and (not methods or planned.method in methods)
        and (not candidates or planned.budget in candidates)
        and planned.case.move.name in moves
        and (deciding is None or any(row.has(planned) for row in deciding))
    ]


def batches(missing: Iterable[Planned]) -> Iterator[list[Planned]]:
    """Yield batches of so many jobs, in order."""
    remaining = iter(missing)
    while batch := list(islice(remaining, BATCH)):
        yield batch


def run_jobs_of(
    missing: Sequence[Planned], folder: Path, results: Path, workers: int | str = 1
) -> int:
    """Run jobs in batches, and pack each; the number of those that failed."""
    print(f"{len(missing)} jobs", flush=True)
    failed = 0
    finished = 0
    for batch in batches(missing):
        by_job = dict[Job, Planned]()
        for planned in batch:
            if planned.takes_every_number:
                front = front_by_every_number(planned, folder)
                pack(results, {planned: (planned.job(folder), front)})
                finished += 1
                continue
            try:
                by_job[planned.job(folder)] = planned
            except qa.QuietarmError as error:
                print(f"{planned.case.name}: {error}", flush=True)
                failed += 1
        try:
            fronts = run_jobs(list(by_job), folder, workers=workers) if by_job else {}
        except LostJobsError as error:
            print(error, flush=True)
            fronts = error.fronts
            failed += len(by_job) - len(fronts)
        pack(results, {by_job[job]: (job, front) for job, front in fronts.items()})
        finished += len(fronts)
        last = batch[-1]
        place = f"round {last.round} {last.axis} {last.case.name}"
        print(f"{finished}/{len(missing)} {place}", flush=True)
    return failed


def front_by_every_number(planned: Planned, folder: Path) -> qa.Front:
    """The front of a method that takes every value of an integer in turn."""
    case = planned.case
    profile = case.integer_profile
    if profile is None:
        raise ValueError(f"{case.name} has no integer")
    name = case.name if not planned.in_turn else f"{planned.method}-{case.name}"
    path = folder / "every-number" / f"{name}-{planned.words}{planned.of_seed}.json"
    if path.exists():
        return qa.Front.load(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if planned.in_turn:
        budget = planned.budget or 0
        front = search_of_every_number(
            case.task, profile, case.bound, planned.method, budget, planned.round
        )
    else:
        points = dict(planned.settings)["points"]
        rehearsal = 3  # points: what is compiled first is no part of the effort
        front_of_every_number(case.task, profile, case.bound, rehearsal)
        front = front_of_every_number(case.task, profile, case.bound, points)
    front.save(path)
    return front


def pack(results: Path, fronts: dict[Planned, tuple[Job, qa.Front]]) -> None:
    """Add runs to the tables of their axes."""
    rows = defaultdict[str, list[Row]](list)
    for planned, (job, front) in fronts.items():
        rows[planned.axis].append(row_of(planned, front, job.problem.reference()))
        _keep_scale(results, job)
    for axis, added in rows.items():
        path = runs_path(results, axis)
        known = {key_of(row): row for row in read_rows(path)}
        write_rows((known | {key_of(row): row for row in added}).values(), path)


def _keep_scale(results: Path, job: Job) -> None:
    """The ends of a problem's scale, in a table."""
    path = results / "scales.csv"
    table = pd.read_csv(path) if path.exists() else pd.DataFrame({"problem": []})
    if job.problem.name in set(table["problem"]):
        return
    scale = job.problem.reference()
    row = {
        "problem": job.problem.name,
        "least_residual_m": scale.ideal[0],
        "least_energy_J": scale.ideal[1],
        "largest_residual_m": scale.nadir[0],
        "largest_energy_J": scale.nadir[1],
        "least_peaks": " ".join(f"{value:.10g}" for value in scale.ideal[2:]),
        "largest_peaks": " ".join(f"{value:.10g}" for value in scale.nadir[2:]),
    }
    table = pd.concat([table, pd.DataFrame([row])], ignore_index=True)
    write_table(table.sort_values("problem"), path, 10)


def describe(folder: Path, results: Path) -> None:
    """Features of the problems of the centre and the crossing that have runs, cheap ones first."""
    run_already = {problem for problem, *_ in done_keys(results)}
    cases = {
        planned.case: None
        for planned in plan_of(results)
        if planned.axis in ("centre", "crossing") and planned.case.name in run_already
    }
    ordered = sorted(cases, key=lambda case: (case.terms != CENTRE_TERMS, case.terms))
    add_features(ordered, folder, results / "landscapes.csv")


def all_rows(results: Path) -> list[Row]:
    """The rows of all tables."""
    paths = sorted((results / "runs").glob("*.csv.xz"))
    return [row for path in paths for row in read_rows(path)]


def plan_table(results: Path) -> pd.DataFrame:
    """By axis: jobs of the plan, those that are done, and hours of all by the mean of those.

    Hours are of the methods alone. A method without runs is taken for the mean of all by its
    candidates. Beyond these hours each job is judged, packed, and in every process rehearsed once.
    """
    plan = plan_of(results)
    rows = all_rows(results)
    done = {key_of(row) for row in rows}
    seconds = defaultdict[tuple[str, str], list[float]](list)
    for row in rows:
        seconds[row["method"], row["budget"]].append(float(row["seconds"]))
    usual = {key: sum(values) / len(values) for key, values in seconds.items()}
    spent = [float(row["seconds"]) / int(row["budget"]) for row in rows if row["budget"]]
    of_candidate = sum(spent) / len(spent) if spent else 1e-4
    table = pd.DataFrame(
        {
            "axis": planned.axis,
            "jobs": 1,
            "done": int(planned.key in done),
            "hours": usual.get(
                (planned.method, str(planned.budget or "")), of_candidate * (planned.budget or 1e4)
            )
            / 3600,
        }
        for planned in plan
    )
    return table.groupby("axis", sort=False).sum().reset_index()


def print_plan(results: Path) -> None:
    """Jobs, hours, and what the tests can tell."""
    table = plan_table(results)
    print(table.round(2).to_string(index=False))
    for moves in (18, 10, 5):
        print(f"signed ranks of {moves} moves can give p = {2 / 2**moves:.2g} at least")
    hours = f"{table['hours'].sum():.1f} hours of one core"
    print(f"{table['jobs'].sum()} jobs, {table['done'].sum()} done, {hours}")
