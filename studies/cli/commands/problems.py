"""`quietarm problems`: the named problems and their reference fronts."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import click
from quietarm.metaheuristics.problems.catalogue import PROBLEMS, NamedProblem, problem_of
from quietarm.studies.cli.ending import Together, finish
from quietarm.studies.cli.options import quiet_option
from quietarm.studies.cli.types import FOLDER, Parsed
from quietarm.studies.display.saving import inside
from quietarm.studies.display.words import error_words
from quietarm.studies.document.blocks import Document, Lines


@click.command()
@click.argument(
    "names", nargs=-1, type=Parsed("problem", lambda text: problem_of(text).name),
    metavar="[PROBLEM]...",
)  # fmt: skip
@click.option("--output", type=FOLDER, help="Write the reference fronts to this folder.")
@quiet_option
def problems(names: tuple[str, ...], output: Path | None, quiet: bool) -> None:
    """List named problems, and write their reference fronts.

    Without PROBLEM all of them. Their fronts come with quietarm; other libraries take the problems
    from Python, as docs/problems.md shows.

    \b
    Examples:
      quietarm problems
      quietarm problems single-link-30deg-0.8s --output fronts
    """  # noqa: D301  # \b is click's: do not rewrap
    chosen = [PROBLEMS[name] for name in dict.fromkeys(names or PROBLEMS)]
    pairs = (zip(one.tasks(), one.fronts(), strict=True) for one in chosen)
    fronts = dict(chain.from_iterable(pairs))
    lines = [*map(_line, chosen)]
    writes = {f"{name}.json": front.save for name, front in fronts.items()}
    what = "front" if len(writes) == 1 else "fronts"
    finish(
        [], Document("", [Lines(lines)]), quiet=quiet,
        together=output and Together(what, output, inside(output, writes)),
    )  # fmt: skip


def _line(problem: NamedProblem) -> str:
    errors = error_words(problem.task)
    limits = ", ".join(f"{name} {most:g}" for name, most in problem.task.limits.items())
    words = [
        f"{problem.name}: {problem.profile.size} coefficients from "
        f"{-problem.bound:g} to {problem.bound:g}",
        f"limits {limits}" if limits else "",
        f"third objective peak {problem.peak}" if problem.peak else "",
        f"the largest residual with {errors}" if errors else "",
    ]
    return ", ".join(filter(None, words))
