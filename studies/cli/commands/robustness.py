"""`quietarm robustness`: what plans leave when the plant is not the assumed one."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import click
from quietarm.ocp import Plan, Robustness, evaluate_robustness
from quietarm.ocp.uncertainty import check_ranges
from quietarm.studies.cli.ending import finish, interruption
from quietarm.studies.cli.options import command, quiet_option
from quietarm.studies.cli.quantities import once
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import FOLDER, INPUT, SHARE, WHOLE
from quietarm.studies.display.progress import count
from quietarm.studies.document.files import document_files
from quietarm.studies.reading.saved import load_plans
from quietarm.studies.reports.robustness import Figured, robustness_document
from rich.console import Console

DEFAULT_RANGES: Mapping[str, float] = {"frequency": 0.2, "damping": 0.5}
"""The errors where none is asked for."""


@command(context_settings={"ignore_unknown_options": True})
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="PLAN ... [--PARAMETER SHARE]")
@click.option("--frequency", type=SHARE, multiple=True,
              help="Largest error of all natural frequencies, as 20%.")  # fmt: skip
@click.option("--damping", type=SHARE, multiple=True,
              help="Largest error of all damping ratios, as 50%.")  # fmt: skip
@click.option("--samples", type=WHOLE, default=10_000, show_default=True,
              help="Monte Carlo samples of each plan, all errors at once.")  # fmt: skip
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Of the samples.")
@click.option("--output", type=FOLDER,
              help="Write table, picture, sweeps and samples to this folder.")  # fmt: skip
@plant_file_option(expose_value=False)
@quiet_option
@click.pass_context
def robustness(
    context: click.Context,
    words: tuple[str, ...],
    frequency: tuple[float, ...],
    damping: tuple[float, ...],
    samples: int,
    seed: int,
    output: Path | None,
    quiet: bool,
) -> None:
    """Show what plans leave, and what they take, when the plant is not the assumed one.

    PLANs are files written by `quietarm plan` or `evaluate`. Any parameter of the plant may be
    wrong: --omega 10% is one by up to 10 % either way. Each error alone gives a curve and the range
    within which the residual stays below 5 % of the plain cycloid's; all at once, drawn at random,
    give percentiles of residual, energy and peak torque. Without any error named: --frequency 20%
    --damping 50%.

    \b
    Examples:
      quietarm robustness plan.json
      quietarm robustness plan.json zvd.json --frequency 20% --output robust
      quietarm robustness plan.json --omega 10% --alpha1 5% --samples 100000
    """  # noqa: D301  # \b is click's: do not rewrap
    pairs = [("frequency", share) for share in frequency]
    pairs += [("damping", share) for share in damping]
    paths, others = _parted(context, words)
    ranges = once([*pairs, *others], "--") or dict(DEFAULT_RANGES)
    plans = load_plans(paths)
    for path, plan in zip(paths, plans.values(), strict=True):
        try:
            check_ranges(plan.task.plant, ranges)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    figured, trouble = _evaluated(plans, ranges, samples, seed, quiet), None
    if len(figured) < len(plans):
        trouble = interruption(f"{len(figured)} of {len(plans)} plans")
    document = robustness_document(figured)
    finish(document_files(output, document), document, trouble=trouble, quiet=quiet)


def _parted(
    context: click.Context, words: tuple[str, ...]
) -> tuple[list[Path], list[tuple[str, float]]]:
    """The plans among the words, and the errors of parameters with their names."""
    paths, errors, rest = list[Path](), list[tuple[str, float]](), list(words)
    while rest:
        word = rest.pop(0)
        if not word.startswith("--"):
            if word.startswith("-"):
                if Path(word).exists():  # click takes the -- away that may have been before it
                    raise ValueError(f"{word} looks like an option; give ./{word}")
                raise click.NoSuchOption(word, ctx=context)
            paths.append(INPUT.convert(word, None, context))
            continue
        option, equals, share = word.partition("=")
        if not equals and not rest:
            raise ValueError(f"{option} has no value; give one, as {option} 10%")
        try:
            errors.append(
                (option[2:].replace("-", "_"), SHARE.parse(share if equals else rest.pop(0)))
            )
        except ValueError as error:
            raise ValueError(f"{option}: {error}") from None
    return paths, errors


def _evaluated(
    plans: Mapping[str, Plan], ranges: Mapping[str, float], samples: int, seed: int, quiet: bool
) -> Figured:
    """The figures of every plan; after Ctrl-C those of the plans until then, if there are any."""
    figured, several = dict[str, tuple[Plan, Robustness]](), len(plans)
    words = samples * several, "evaluations", Console(stderr=True)
    with suppress(KeyboardInterrupt), count(*words, quiet=quiet) as report:
        for number, (label, plan) in enumerate(plans.items()):

            def told(done: int, total: int, number: int = number) -> None:
                report(number * total + done, several * total)

            figured[label] = plan, evaluate_robustness(
                plan.task, plan.profile, plan.coefficients, ranges,
                samples=samples, seed=seed, report=told,
            )  # fmt: skip
    if not figured:
        raise KeyboardInterrupt
    return figured
