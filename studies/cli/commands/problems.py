"""`quietarm problems`: the named problems and their exact fronts."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from itertools import chain
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
    if again:
        fronts = _found_again(chosen, quiet)
        if not fronts:
            raise KeyboardInterrupt
    else:
        pairs = (zip(one.tasks(), one.fronts(), strict=True) for one in chosen)
        fronts = dict(chain.from_iterable(pairs))
    certified = [
        f"{one.front}: version {problem.version}, {one.points} points, SHA-256 {one.checksum}"
        for problem in (chosen if names else ())
        for one in problem.certificates()
    ]
    lines = [*map(_line, chosen), *certified]
    writes = {f"{name}.json": front.save for name, front in fronts.items()}
    what = "front" if len(writes) == 1 else "fronts"
    finish(
        [], Document("", [Lines(lines)]), quiet=quiet,
        trouble=interruption() if len(fronts) < _number(chosen) else None,
        together=output and Together(what, output, inside(output, writes)),
    )  # fmt: skip


def _number(chosen: Sequence[NamedProblem]) -> int:
    return sum(len(problem.tasks()) for problem in chosen)


def _verify(chosen: Sequence[NamedProblem], quiet: bool) -> None:
    from quietarm.metaheuristics.problems.certificate import Certificates, certified
    from quietarm.studies.reports.certificates import certificates_document, not_holding

    kept = Certificates.kept()
    with progress(_number(chosen), Console(stderr=True), quiet=quiet) as begin:
        found = [one for problem in chosen for one in certified(problem, begin)]
    failed = not_holding(found, kept)
    trouble = QuietarmError("; ".join(failed)) if failed else None
    finish([], certificates_document(found), trouble=trouble, quiet=quiet)


def _found_again(chosen: Sequence[NamedProblem], quiet: bool) -> dict[str, Front]:
    """Fronts that are found anew, whole ones alone, until an interruption."""
    fronts = dict[str, Front]()
    words = _number(chosen), Console(stderr=True)
    with suppress(KeyboardInterrupt), progress(*words, quiet=quiet) as begin:
        for problem in chosen:
            found = problem.find_again(begin)
            if not all(front.complete for front in found.values()):
                break
            fronts |= found
    return fronts


def _line(problem: NamedProblem) -> str:
    errors = error_words(problem.task)
    limits = ", ".join(map(str, problem.task.limits))
    words = [
        f"{problem.name}: {problem.profile.size} coefficients from "
        f"{-problem.bound:g} to {problem.bound:g}",
        f"limits {limits}" if limits else "",
        f"third objective peak {problem.peak}" if problem.peak else "",
        f"the largest residual with {errors}" if errors else "",
    ]
    return ", ".join(filter(None, words))
