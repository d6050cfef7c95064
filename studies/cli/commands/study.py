"""`quietarm study`: every method on a task, or on all of the paper's, in one report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from quietarm.metaheuristics import PRESETS
from quietarm.ocp import PointToPoint
from quietarm.studies.cli.options import (
    command,
    latex_option,
    method_settings_option,
    quiet_option,
    settings_by_method,
    typed,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.task import own_task_options
from quietarm.studies.cli.types import FOLDER, INPUT, PAGE, WHOLE, Named
from quietarm.studies.registry.methods import PAPERS
from rich.console import Console


@command()
@own_task_options
@click.option("--bound", type=float, help="Largest coefficient; the paper's for its plants.")
@click.option("--terms", type=WHOLE, default=6, show_default=True, help="Terms of the polynomial.")
@click.option(
    "--points", type=WHOLE, default=50, show_default=True, help="Points of the gradient's fronts."
)
@click.option(
    "--runs", type=WHOLE, default=3, show_default=True, help="Seeds of each metaheuristic."
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="First seed.")
@click.option(
    "--method", "methods", type=Named("metaheuristic", PRESETS), multiple=True,
    default=[method.name for method in PAPERS], show_default=True,
    help="A metaheuristic to run; may be repeated.",
)  # fmt: skip
@workers_options
@click.option(
    "--population", type=WHOLE,
    help="Individuals, or particles in a swarm; docs/methods.md has the defaults.",
)  # fmt: skip
@click.option("--generations", type=WHOLE, help="Generations.")
@method_settings_option("as in --setting nsga2.crossover=0.7")
@click.option(
    "--output", type=PAGE, default="study.html", show_default=True, help="Write the report here."
)
@click.option(
    "--front", "given", type=INPUT, multiple=True,
    help="Compare with this front as well, as quietarm import writes one; may be repeated.",
)  # fmt: skip
@click.option("--fronts", type=FOLDER, help="Write every front to this folder.")
@latex_option
@quiet_option
def study(
    task: PointToPoint | None,
    bound: float | None,
    methods: Sequence[str],
    setting: Sequence[tuple[str, str]],
    output: Path,
    given: Sequence[Path],
    fronts: Path | None,
    latex: Path | None,
    quiet: bool,
    **amounts: Any,
) -> None:
    """Run every method on a task, compare what they find, and write one page of HTML.

    Without PLANT, on all six conditions of the paper, which takes some minutes. The methods:
    fronts by gradient (epsilon-constraint and weighted sum), NSGA-II and VEPSO or other
    metaheuristics from several seeds, each polished by the gradient, and the floor. The page stands
    alone: pictures are inside.

    \b
    Examples:
      quietarm study --output study.html
      quietarm study arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 --runs 5
      quietarm study single-link --target 30deg --duration 0.8 --torque-limit 0.2 --fronts fronts
      quietarm study single-link --target 30deg --duration 0.8 --method smsemoa --method gde3
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.ocp import QuietarmError
    from quietarm.studies.cli.ending import Together, finish
    from quietarm.studies.display.progress import progress
    from quietarm.studies.display.words import counted
    from quietarm.studies.document.blocks import Bullets, Document
    from quietarm.studies.document.latex import latex_file
    from quietarm.studies.paper import CONDITIONS, Case
    from quietarm.studies.reading.saved import load_front
    from quietarm.studies.study.findings import case_findings, findings
    from quietarm.studies.study.page import front_files, page_file, study_document
    from quietarm.studies.study.work import StudySettings, amount_of_work, run_study

    settings = StudySettings(
        **amounts,
        methods=tuple(dict.fromkeys(methods)),
        settings=settings_by_method(setting, methods),
        fronts=tuple(map(load_front, given)),
    )
    if task is None and typed("bound"):
        raise click.UsageError("--bound is for a task of your own: give its plant as well")
    cases = CONDITIONS if task is None else (Case(task, bound),)
    errors, total = Console(stderr=True), amount_of_work(cases, settings)
    warn_of_workers(errors, settings.workers, total)
    with progress(total, errors, quiet=quiet) as begin:
        result = run_study(cases, settings, begin)

    found = findings(result) if len(cases) > 1 else case_findings(result.cases[0])
    trouble = None
    if result.done is not None:
        trouble = QuietarmError(
            f"{result.stopped}: {result.done} of {counted(total, 'piece')} of work are done; what "
            "was found until then is kept"
        )
    together = None
    if fronts is not None:
        together = Together("fronts", fronts, front_files(result, fronts))
    page = [page_file(result, output), latex_file(latex, study_document(result))]
    finish(page, Document("", [Bullets(found)]), trouble=trouble, together=together, quiet=quiet)
