"""What `quietarm robustness` does: plans from files over errors of their plants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from quietarm.ocp import Plan, Robustness, evaluate_robustness
from quietarm.ocp.robustness.uncertain import assumed_plant
from quietarm.ocp.simulation.errors import checked_ranges
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import finish, interruption
from quietarm.studies.report.files import document_files
from quietarm.studies.report.terminal import show
from quietarm.studies.runs.loading import load_plans
from quietarm.studies.runs.reports.robustness import Figured, robustness_document
from rich.console import Console

DEFAULT_RANGES: Mapping[str, float] = {"frequency": 0.2, "damping": 0.5}
"""The errors where none is asked for."""


def run_robustness(
    paths: Sequence[Path],
    ranges: Mapping[str, float],
    samples: int,
    seed: int,
    output: Path | None,
    quiet: bool,
) -> None:
    """Evaluate saved plans over errors of their plants, show the figures and write them."""
    ranges = dict(ranges) or dict(DEFAULT_RANGES)
    plans = load_plans(paths)
    for path, plan in zip(paths, plans.values(), strict=True):
        try:
            checked_ranges(assumed_plant(plan.task.plant), ranges)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    figured, trouble = _evaluated(plans, ranges, samples, seed, quiet), None
    if len(figured) < len(plans):
        trouble = interruption(f"{len(figured)} of {len(plans)} plans")
    document = robustness_document(figured)
    files = [] if output is None else document_files(output, document)
    finish(files, partial(show, document=document), trouble=trouble, quiet=quiet)


@contextmanager
def _keeping(found: Mapping[str, object]) -> Iterator[None]:
    """Let Ctrl-C end the block, but raise it where nothing was found."""
    try:
        yield
    except KeyboardInterrupt:
        if not found:
            raise


def _evaluated(
    plans: Mapping[str, Plan], ranges: Mapping[str, float], samples: int, seed: int, quiet: bool
) -> Figured:
    """The figures of every plan; after Ctrl-C those of the plans until then, if there are any."""
    figured: dict[str, tuple[Plan, Robustness]] = {}
    words = samples * len(plans), "evaluations", Console(stderr=True)
    with _keeping(figured), count(*words, quiet=quiet) as report:
        for number, (label, plan) in enumerate(plans.items()):

            def told(done: int, total: int, number: int = number) -> None:
                report(number * total + done, len(plans) * total)

            figured[label] = plan, evaluate_robustness(
                plan.task, plan.profile, plan.coefficients, ranges,
                samples=samples, seed=seed, report=told,
            )  # fmt: skip
    return figured
