"""`quietarm bench`: methods of all kinds against the reference front of each problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
from rich.console import Console

from quietarm.studies.cli.effort import refuse_endless
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import (
    METHOD_SETTING,
    NOISE,
    OBJECTIVES,
    PART,
    SCHEDULER,
    SEED,
    WORKERS,
    YES,
    command,
    counting,
    option,
    progress_console,
)
from quietarm.studies.cli.outputs import check_folder
from quietarm.studies.cli.quantities import read_settings
from quietarm.studies.cli.types import INPUT, NAMES, Parsed

if TYPE_CHECKING:
    from pathlib import Path

    from quietarm.studies.bench.results import Results


def read_evaluations(text: str | int) -> int | None:
    """A number of candidates; None for each method's own."""
    if text == "preset":
        return None
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"{text!r} is no whole number; give one, or preset") from None


@command(
    click.Argument(["problems"], nargs=-1, required=True, metavar="PROBLEM..."),
    option("--methods", default="nsga2,vepso,epsilon", type=NAMES, metavar="NAME,NAME,...",
           help="Searches, polished by the gradient as nsga2+polish; epsilon, weighted and "
           "multistart are the gradient alone, by SQP or by IPOPT (epsilon:ipopt); memetic is a "
           "search with steps of the gradient, slsqp takes differences."),
    option("--runs", default=15, help="Seeds of each method."),
    option("--evaluations", default=10_000, type=Parsed("number", read_evaluations),
           help="Candidates of each run of a search; preset gives each method those of its own "
           "population and generations, and nsga2-paper and vepso the paper's."),
    OBJECTIVES, *NOISE, SEED, METHOD_SETTING,
    option("--import", "imported", multiple=True, type=INPUT,
           help="A run of another library, by a recorded function, or a folder of such runs; in a "
           "folder, runs on other problems are left out."),
    option("--output", "-o", type=Parsed("folder", check_folder), required=True,
           help="Folder for runs and report; runs that are there are kept, and so is a report that "
           "has more."),
    option("--iohprofiler", is_flag=True, help="Also write the runs for IOHprofiler's analyser, "
           "into the folder iohprofiler of --output."),
    PART, WORKERS, SCHEDULER, YES,
)  # fmt: skip
def bench(given: Given) -> None:
    """Compare methods with the reference front of each PROBLEM, with several seeds.

    PROBLEM is a name of `quietarm list`, or a front's file, whose move, profile, bound and
    objectives are the problem and which is its reference front; `all` are the named problems with
    two objectives. With --objectives the gradient finds the reference fronts first. --noise is of
    the searches: the gradient is that of the model, which has none.
    Every run is a file in the folder as soon as it is done; the same line again goes on after any
    stop. A bench of your own function is made in Python: docs/problems.md. When a search is worth
    its candidates at all: docs/results/report.md.

    \b
    Examples:
      quietarm bench single-link-30deg-0.8s --output bench
      quietarm bench all --methods vepso,nsga2-paper --evaluations preset --output paper
      quietarm bench all --methods nsga2,gde3,epsilon,epsilon:ipopt --runs 15 --output bench
      quietarm bench single-link-30deg-0.8s --methods nsga2,epsilon --noise 1% --output noisy
      quietarm bench single-link-30deg-0.8s --methods nsga3,epsilon \\
          --objectives residual,energy,peak-torque --output three
      quietarm bench mine.json --methods nsga2,nsga2+polish --evaluations 2000 --output mine
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.metaheuristics import LostJobsError, finished_jobs, run_jobs
    from quietarm.metaheuristics.parallel import reach_scheduler
    from quietarm.metaheuristics.search_run import SECONDS_OF_CANDIDATE
    from quietarm.studies.answers.read_answers import load_runs
    from quietarm.studies.bench.bench_page import reported_runs
    from quietarm.studies.bench.planned_jobs import (
        imports_on,
        jobs_of,
        problems_of,
        spell_method,
        with_references,
        write_references,
    )
    from quietarm.studies.bench.results import Results, imported_runs
    from quietarm.studies.bench.statistics import say_power_of
    from quietarm.views.report.terminal import print_lines

    methods = list(map(spell_method, given.methods))
    settings = read_settings((spell_method(name), text) for name, text in given.settings)
    objectives = given.objectives if given.typed("objectives") else None
    problems = problems_of(given.problems, objectives)
    noise = given.pick("noise", "reevaluate")
    asked = methods, given.runs, given.evaluations, given.seed, settings
    jobs_of(problems, *asked, **noise)  # refuses before a reference front takes its seconds
    problems = with_references(problems, given.output)
    jobs, left_out = jobs_of(problems, *asked, **noise)
    candidates = sum(job.budget or 0 for job in jobs)
    refuse_endless(candidates, "candidates", SECONDS_OF_CANDIDATE, yes=given.yes)
    runs, unreadable = load_runs(given.imported)
    imported, not_imported = imports_on(problems, runs, given.imported)
    reported_runs(given.output)  # refuses a folder whose runs.csv is another's
    planned = [(job.problem.name, job.label) for job in jobs]
    planned += [(run.problem.name, run.method) for run in imported_runs(imported, jobs)]
    finished = finished_jobs(jobs, given.output)  # refuses a changed file before anything is done
    there = [f"{len(finished)} of {len(jobs)} runs are in {given.output}"] if finished else []
    print_lines(
        progress_console(),
        *left_out,
        *unreadable,
        *not_imported,
        say_power_of(planned),
        *there,
    )
    workers = given.scheduler or given.workers
    if len(finished) < len(jobs):
        reach_scheduler(workers)  # before anything is written
    write_references(problems, given.output)
    trouble = None
    with counting(len(jobs), "jobs") as progress:
        try:
            fronts = run_jobs(
                jobs,
                given.output,
                workers=workers,
                part=given.part,
                report=lambda job, front, done, total: progress(done, total),
                finished=finished,
            )
        except LostJobsError as error:
            fronts = dict(error.fronts)
            trouble = error
    if fronts or trouble is None:
        results = Results.of_jobs(fronts, imported)
        _report(results, given)
        if given.iohprofiler:
            _write_iohprofiler(results, given.output / "iohprofiler")
    if trouble is not None:
        others = list(trouble.failures.items())[1:]
        print_lines(progress_console(), *(f"{name}: {why}" for name, why in others))
        raise trouble


def _report(results: Results, given: Given) -> None:
    """Write the report, unless one that is there has more, and show what is in short."""
    from quietarm.studies.bench.bench_page import (
        bench_report,
        brief_report,
        not_reported_again,
        reported_runs,
    )
    from quietarm.views.report import show
    from quietarm.views.report.words import counted

    lost = not_reported_again(results, reported_runs(given.output))
    files = [] if lost else bench_report(results, given.line).files(given.output)
    for path, write in files:
        write(path)
    show(Console(), brief_report(results))
    click.echo(
        f"report.md in {given.output} stays: {counted(lost, 'run')} in it would be lost. Ask for "
        "those as well, give another folder, or delete it"
        if lost
        else f"wrote report.md and {len(files) - 1} tables and pictures to {given.output}"
    )


def _write_iohprofiler(results: Results, folder: Path) -> None:
    """Write the runs for IOHprofiler's analyser, and say what it has not."""
    from quietarm.studies.bench.iohprofiler import write_iohprofiler
    from quietarm.views.report.words import counted

    written, left_out = write_iohprofiler(results, folder)
    without = f"; {', '.join(left_out)}: left out, counts no candidates" if left_out else ""
    click.echo(f"wrote {counted(len(written), 'file')} for IOHprofiler to {folder}{without}")
