"""`quietarm bench`: methods of all kinds against the reference front of each problem."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.files import check_folder
from quietarm.studies.cli.options import (
    command,
    counting,
    option,
    part_option,
    quiet,
    scheduler_option,
    seed_option,
    setting_option,
    settings_by_method,
    typed_line,
    workers_option,
)
from quietarm.studies.cli.types import INPUT, Parsed
from rich.console import Console


@command()
@click.argument("problems", nargs=-1, required=True, metavar="PROBLEM...")
@option(
    "--methods", default="nsga2,vepso,epsilon", metavar="NAME,NAME,...",
    help="Searches, polished by the gradient as nsga2+polish; epsilon, weighted and multistart are "
    "the gradient alone, by SQP or by IPOPT (epsilon:ipopt).",
)  # fmt: skip
@option("--runs", default=15, help="Seeds of each method.")
@option("--evaluations", default=10_000, help="Candidates of each run of a search.")
@seed_option
@setting_option
@option("--import", "imported", multiple=True, type=INPUT,
        help="A run of another library, by a recorded function; may be repeated.")  # fmt: skip
@option("--output", type=Parsed("folder", check_folder), required=True,
        help="Folder for runs and report; runs that are there are kept.")  # fmt: skip
@part_option
@workers_option
@scheduler_option
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
    from quietarm.studies.bench.results import Results, imported_runs
    from quietarm.studies.bench.statistics import say_power_of
    from quietarm.studies.report import show
    from quietarm.studies.report.words import print_lines

    known = {spelling(name): name for name in (*PRESETS, *GRADIENT)}

    def named(typed: str) -> str:
        name, plus, polish = typed.strip().partition("+")
        return known.get(spelling(name), name) + plus + polish

    names = [named(one) for one in methods.split(",")]
    parts = [(name.partition("."), value) for name, value in setting]
    own = [(named(method) + dot + name, value) for (method, dot, name), value in parts]
    chosen, errors = problems_of(problems), Console(stderr=True)
    jobs, left_out = jobs_of(chosen, names, runs, evaluations, seed, settings_by_method(own, names))
    given = [Front.load(path) for path in imported]
    planned = [(job.problem.name, job.label) for job in jobs]
    planned += [(run.problem.name, run.method) for run in imported_runs(given, chosen)]
    if not quiet():
        print_lines(errors, *left_out, say_power_of(planned))
    write_references(chosen, output)
    trouble: QuietarmError | None = None
    with counting(len(jobs), "jobs") as progress:
        try:
            fronts = run_jobs(
                jobs, output, workers=workers, scheduler=scheduler, part=part,
                report=lambda job, front, done, total: progress(done, total),
            )  # fmt: skip
        except LostJobsError as error:
            fronts, trouble = dict(error.fronts), error
    if not fronts and trouble is not None:
        raise trouble
    results = Results.of_jobs(fronts, given)
    report = bench_report(results, typed_line())
    files = report.files(output)
    for path, write in files:
        write(path)
    show(Console(), brief_report(results))
    click.echo(f"wrote report.md and {len(files) - 1} tables and pictures to {output}")
    if trouble is not None:
        raise trouble
