"""What the commands do with a metaheuristic: one plan from its front, or the front itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quietarm.metaheuristics import search
from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL, LostSeedsError, search_many, seeds_of
from quietarm.ocp import (
    Front,
    JointProfile,
    Plan,
    PointToPoint,
    QuietarmError,
    SolverFailedError,
    SolveSettings,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.base.files import check_writable
from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.ocp.plan.robust import limit_of
from quietarm.studies.display.saving import STDOUT, File, drawing, finish
from quietarm.studies.display.search_progress import search_display
from quietarm.studies.registry.methods import Method
from quietarm.studies.runs.files import FrontFiles, refuse_same_file, warn_of_workers
from quietarm.studies.runs.reports.search import print_fronts
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plan_by_search(
    task: PointToPoint,
    method: Method,
    profile: JointProfile,
    bound: float | None,
    residual_limit: float | None,
    seed: int,
    polish: bool,
    quiet: bool = False,
    settings: Mapping[str, object] | None = None,
) -> Plan:
    """The cheapest point of a metaheuristic's front within the residual limit, as a plan."""
    limit = limit_of(task, residual_limit) or SEARCH_RESIDUAL
    SolveSettings(residual_limit=limit, seed=seed)  # refused before the search, not after
    with search_display(Console(stderr=True), quiet=quiet) as report:
        front = search(
            task, method.name, profile=profile, bound=bound, settings=settings, seed=seed,
            report=report,
        )  # fmt: skip
    if not front.complete:
        raise QuietarmError(
            "interrupted; a plan needs a whole search, and nothing was written; `quietarm front` "
            "keeps what a search has found until Ctrl-C"
        )
    try:
        point = front.cheapest(limit)
    except ValueError as error:
        raise SolverFailedError(f"{method.label} found no such plan: {error}") from None
    used = {**front.settings, "seed": seed, "residual_limit": limit}
    stopped = None
    if polish:
        try:
            polished = plan_move(
                task, profile, residual_limit=residual_limit, bound=bound, starts=1, seed=seed,
                guess=point.coefficients,
            )  # fmt: skip
        except KeyboardInterrupt:
            stopped = "the search, before its point was polished"
        else:
            provenance = replace(
                polished.provenance,
                method=f"{method.name}, polished by ipopt",
                search=used,
                seconds=front.seconds + polished.provenance.seconds,
            )
            return replace(polished, provenance=provenance)
    with note_interrupts() if stopped else nullcontext():
        found = evaluate_coefficients(
            task, point.coefficients, profile=profile, method=method.name, settings=used
        )
    provenance = replace(found.provenance, seconds=front.seconds, stopped=stopped)
    return replace(found, provenance=provenance)


def run_front(
    task: PointToPoint,
    method: Method,
    options: dict[str, Any],
    files: FrontFiles,
    quiet: bool,
) -> None:
    """Search from every seed, write what was found, and show it."""
    runs = options["runs"]
    if runs > 1 and (options.get("checkpoint") or options.get("resume")):
        raise ValueError(
            "--checkpoint and --resume are for one run, not with --runs; leave one of them out"
        )
    seeds = seeds_of(options["seed"], runs)
    targets = _targets("--output", files.output, seeds)
    tables = _targets("--csv", files.csv, seeds)
    _refuse_same_files([*targets.values()], [*tables.values()], options, files.figure)
    errors = Console(stderr=True)
    found, lost, troubles = _fronts(errors, task, method, options, quiet)
    fronts = [front for front in found if front.complete or front.points]
    stopped = "" if lost else _interruption(fronts, runs)
    if not any(front.points for front in fronts):
        if stopped:
            raise KeyboardInterrupt
        raise lost or SolverFailedError(f"{method.name}: {fronts[0].why_empty()}")

    def picture() -> Figure:
        from quietarm.studies.figures import front_figure

        return front_figure(fronts)

    trouble = lost
    if stopped or troubles:
        trouble = lost or QuietarmError("; ".join([*filter(None, [stopped]), *troubles]))
    written: list[File] = [(targets.get(front.seed or 0), front.save) for front in fronts]
    written += [(tables.get(front.seed or 0), front.save_csv) for front in fronts]
    finish(
        [*written, (files.figure, drawing(picture))],
        lambda console: print_fronts(console, fronts),
        trouble=trouble,
    )


def _fronts(
    errors: Console, task: PointToPoint, method: Method, options: Mapping[str, Any], quiet: bool
) -> tuple[list[Front], LostSeedsError | None, list[str]]:
    """What every seed found, the error of those whose process died, and warnings."""
    runs, troubles = options["runs"], list[str]()
    warn_of_workers(errors, options["workers"], runs)
    with search_display(errors, quiet=quiet) as display:
        several = {"report": display, "done": display.finish}
        one = {"report": lambda progress, seed: display(progress), "warn": troubles.append}
        try:
            how = several if runs > 1 else one
            return search_many(task, method.name, **how, **options), None, troubles
        except LostSeedsError as error:
            return error.fronts, error, troubles


def _interruption(fronts: Sequence[Front], runs: int) -> str:
    """The message for searches that were interrupted; empty where none was."""
    done = sum(front.complete for front in fronts)
    if done == runs:
        return ""
    if runs == 1:
        return "interrupted; what was found until then is kept"
    part = f", {len(fronts) - done} in part" * (done < len(fronts))
    return f"interrupted: {done} of {runs} seeds are done{part}; these are kept"


def with_seed(path: Path, seed: int) -> Path:
    """The file for one of several seeds: front.json is front-seed3.json for seed 3."""
    return path.with_stem(f"{path.stem}-seed{seed}")


def _refuse_same_files(
    outputs: Sequence[Path],
    tables: Sequence[Path],
    options: Mapping[str, Any],
    figure: Path | None,
) -> None:
    written: list[tuple[str, Path | None]] = [("--output", path) for path in outputs]
    written += [*(("--csv", path) for path in tables), ("--figure", figure)]
    refuse_same_file([*written, ("--checkpoint", options.get("checkpoint"))])
    # a checkpoint may be continued in the same file, but not overwritten by a front
    refuse_same_file([*written, ("--resume", options.get("resume"))])


def _targets(option: str, output: Path | None, seeds: range) -> dict[int, Path]:
    if output is None:
        return {}
    if len(seeds) == 1:
        return {seeds[0]: output}
    if output is STDOUT:
        raise ValueError(f"{option} {output} is for one run; with --runs give the name of a file")
    return {seed: check_writable(with_seed(output, seed)) for seed in seeds}
