"""`quietarm problems`: the named problems and their exact fronts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
from quietarm.metaheuristics.problems.catalogue import PROBLEMS, NamedProblem, problem_of
from quietarm.ocp import Front, QuietarmError
from quietarm.studies.cli.ending import Together, finish, interruption
from quietarm.studies.cli.options import quiet_option
from quietarm.studies.cli.types import FOLDER, Parsed
from quietarm.studies.display.progress import progress
from quietarm.studies.display.saving import inside
from quietarm.studies.display.words import error_words
from quietarm.studies.document.blocks import Document, Lines
from rich.console import Console


@click.command()
@click.argument(
    "names", nargs=-1, type=Parsed("problem", lambda text: problem_of(text).name),
    metavar="[PROBLEM]...",
)  # fmt: skip
@click.option("--again", is_flag=True, help="Find the exact fronts anew; some minutes each.")
@click.option("--verify", is_flag=True,
              help="Check the exact fronts anew, against their certificates.")  # fmt: skip
@click.option("--output", type=FOLDER, help="Write the exact fronts to this folder.")
@quiet_option
def problems(
    names: tuple[str, ...], again: bool, verify: bool, output: Path | None, quiet: bool
) -> None:
    """List named problems, and write their exact fronts.

    Without PROBLEM all of them. Their fronts come with quietarm; other libraries take the problems
    from Python, as docs/problems.md shows.

    \b
    Examples:
      quietarm problems
      quietarm problems single-link-30deg-0.8s --output fronts
      quietarm problems --verify single-link-30deg-0.8s
      quietarm problems --again --output fronts
    """  # noqa: D301  # \b is click's: do not rewrap
    chosen = [PROBLEMS[name] for name in dict.fromkeys(names or PROBLEMS)]
    if again and output is None:
        raise ValueError("--again finds fronts for a folder; give --output as well")
    if verify:
        if again or output is not None:
            raise ValueError("--verify writes nothing; leave --again and --output out")
        _verify(chosen, quiet)
        return
    fronts, trouble = dict[str, Front](), None
    if again and not _find_again(chosen, fronts, quiet):
        if not fronts:
            raise KeyboardInterrupt
        trouble = interruption()
    elif not again:
        for problem in chosen:
            fronts |= zip(problem.tasks(), problem.fronts(), strict=True)
    certified = [
        f"{one.front}: version {problem.version}, {one.points} points, SHA-256 {one.checksum}"
        for problem in chosen
        for one in problem.certificates()
    ]
    together = None
    if output is not None and fronts:
        writes = {f"{name}.json": front.save for name, front in fronts.items()}
        together = Together(
            "front" if len(writes) == 1 else "fronts", output, inside(output, writes)
        )
    finish(
        [], Document("", [Lines([*map(_line, chosen), *(certified if names else ())])]),
        trouble=trouble,
        together=together, quiet=quiet,
    )  # fmt: skip


def _verify(chosen: Sequence[NamedProblem], quiet: bool) -> None:
    from quietarm.metaheuristics.problems.certificate import Certificates, certified
    from quietarm.studies.reports.certificates import certificates_document, not_holding

    kept = Certificates.kept()
    total = sum(len(problem.tasks()) for problem in chosen)
    with progress(total, Console(stderr=True), quiet=quiet) as begin:
        found = [one for problem in chosen for one in certified(problem, begin)]
    failed = not_holding(found, kept)
    trouble = QuietarmError("; ".join(failed)) if failed else None
    finish([], certificates_document(found), trouble=trouble, quiet=quiet)


def _find_again(chosen: Sequence[NamedProblem], fronts: dict[str, Front], quiet: bool) -> bool:
    """Find fronts anew, whole ones alone; whether all were found before an interruption."""
    total = sum(len(problem.tasks()) for problem in chosen)
    with progress(total, Console(stderr=True), quiet=quiet) as begin:
        for problem in chosen:
            try:
                found = problem.find_again(begin)
            except KeyboardInterrupt:
                return False
            if not all(front.complete for front in found.values()):
                return False
            fronts |= found
    return True


def _line(problem: NamedProblem) -> str:
    errors = error_words(problem.task.plant)
    limits = ", ".join(f"{name} {most:g}" for name, most in problem.task.limits.items())
    words = [
        f"{problem.name}: {problem.profile.size} coefficients from "
        f"{-problem.bound:g} to {problem.bound:g}",
        f"limits {limits}" if limits else "",
        f"third objective peak {problem.peak}" if problem.peak else "",
        f"the largest residual with {errors}" if errors else "",
    ]
    return ", ".join(filter(None, words))
