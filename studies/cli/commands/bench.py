"""`quietarm bench`: methods of all kinds against the reference front of each problem."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.files import check_folder
from quietarm.studies.cli.options import (
    command,
    part_option,
    quiet,
    settings_by_method,
    settings_option,
    typed_line,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.types import INPUT, WHOLE, Parsed
from rich.console import Console


@command()
@click.argument("problems", nargs=-1, required=True, metavar="PROBLEM...")
@click.option(
    "--methods", default="nsga2,vepso,epsilon", show_default=True, metavar="NAME,NAME,...",
    help="Searches, as they are or polished by the gradient (nsga2+polish); epsilon, weighted and "
    "multistart are the gradient alone, by SQP or by IPOPT (epsilon:ipopt).",
)  # fmt: skip
@click.option("--runs", type=WHOLE, default=15, show_default=True, help="Seeds of each method.")
@click.option(
    "--evaluations", type=WHOLE, default=10_000, show_default=True,
    help="Candidates of each run of a search.",
)  # fmt: skip
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="First seed.")
@settings_option("a setting of a method, as nsga2.crossover=0.7 or epsilon.points=20")
@click.option(
    "--import", "imported", multiple=True, type=INPUT,
    help="A run of another library that a recorded function wrote; may be repeated.",
)  # fmt: skip
@click.option(
    "--output", type=Parsed("folder", check_folder), required=True,
    help="Folder for runs and report; runs that are there are not done again.",
)  # fmt: skip
@part_option
@workers_options
def bench(
    problems: tuple[str, ...],
    methods: str,
    runs: int,
    evaluations: int,
    seed: int,
    setting: tuple[tuple[str, str], ...],
    imported: tuple[Path, ...],
    output: Path,
    part: tuple[int, int],
    workers: int,
    scheduler: str | None,
) -> None:
    """Hold methods against the reference front of each PROBLEM, from several seeds.

    PROBLEM is a name of `quietarm list`, or a front's file, whose move, profile and bound are the
    problem and which is its reference front; `all` are the named problems with two objectives.
    Every run is a file in the folder as soon as it is done; the same line again goes on after any
    stop.

    \b
    Examples:
      quietarm bench single-link-30deg-0.8s --output bench
      quietarm bench all --methods nsga2,gde3,epsilon,epsilon:ipopt --runs 15 --output bench
      quietarm bench mine.json --methods nsga2,nsga2+polish --evaluations 2000 --output mine
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.metaheuristics import PRESETS, LostJobsError, run_jobs
    from quietarm.metaheuristics.gradient import GRADIENT
    from quietarm.ocp import Front
    from quietarm.ocp.checks import spelling
    from quietarm.ocp.errors import QuietarmError
    from quietarm.studies.bench.asked import jobs_of, problems_of, write_references
    from quietarm.studies.bench.page import bench_report, brief_report
    from quietarm.studies.bench.results import Results
    from quietarm.studies.bench.statistics import say_power
    from quietarm.studies.report import show
    from quietarm.studies.report.progress import progress
    from quietarm.studies.report.words import print_lines

    known = {spelling(name): name for name in (*PRESETS, *GRADIENT)}
    parts = [name.strip().partition("+") for name in methods.split(",")]
    names = [known.get(spelling(name), name) + plus + polish for name, plus, polish in parts]
    chosen, errors = problems_of(problems), Console(stderr=True)
    jobs, left_out = jobs_of(
        chosen, names, runs, evaluations, seed, settings_by_method(setting, names)
    )
    given = [Front.load(path) for path in imported]
    if not quiet():
        print_lines(errors, *left_out, say_power(runs, len(names)))
        warn_of_workers(workers, len(jobs))
    write_references(chosen, output)
    trouble: QuietarmError | None = None
    with progress(len(jobs), errors, quiet=quiet()) as begin:
        try:
            fronts = run_jobs(
                jobs, output, workers=workers, scheduler=scheduler, part=part,
                report=lambda job, front, done, total: begin(job.name),
            )  # fmt: skip
        except LostJobsError as error:
            fronts, trouble = dict(error.fronts), error
    if not fronts and trouble is not None:
        raise trouble
    report = bench_report(Results.of_jobs(fronts, given), typed_line())
    files = report.files(output)
    for path, write in files:
        write(path)
    show(Console(), brief_report(Results.of_jobs(fronts, given)))
    click.echo(f"wrote report.md and {len(files) - 1} tables and pictures to {output}")
    if trouble is not None:
        raise trouble
