"""What the commands do with a metaheuristic: one plan from its front, or the front itself."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console

from metaheuristics import search
from metaheuristics.ensemble import STILL, energies_at, hypervolumes, search_many
from ocp import (
    CycloidPolynomial,
    Front,
    Plan,
    PointToPoint,
    SolverFailedError,
    SolveSettings,
    evaluate_coefficients,
    plan_move,
)
from ocp.files import check_writable
from studies.figures import save_figure
from studies.front_figure import front_figure
from studies.search_display import search_display


def plan_by_search(
    task: PointToPoint,
    method: str,
    profile: CycloidPolynomial,
    bound: float | None,
    residual_limit: float,
    seed: int,
    polish: bool,
) -> Plan:
    """The cheapest point of a metaheuristic's front within the residual limit, as a plan.

    Parameters
    ----------
    task : PointToPoint
        The move.
    method : str
        ``"nsga2"`` or ``"vepso"``, with the paper's settings.
    profile : CycloidPolynomial
        How the joint moves.
    bound : float or None
        Largest absolute coefficient; required, None gives the error that says so.
    residual_limit : float
        Largest residual [m]; 0 stands for `STILL`, since no search arrives quite at rest.
    seed : int
        Seed of the search.
    polish : bool
        Improve the point by the gradient, at the residual limit that was asked for.

    Returns
    -------
    Plan
        The plan, verified by CVODES.
    """
    SolveSettings(residual_limit=residual_limit, seed=seed)  # refused before the search, not after
    with search_display(Console(stderr=True)) as report:
        front = search(task, method, profile=profile, bound=bound, seed=seed, report=report)
    if not front.complete:
        raise KeyboardInterrupt
    try:
        point = front.cheapest(residual_limit or STILL)
    except ValueError as error:
        raise SolverFailedError(f"{method} found no such plan: {error}") from None
    settings = {**front.settings, "seed": seed, "residual_limit": residual_limit or STILL}
    if polish:
        polished = plan_move(
            task,
            profile,
            residual_limit=residual_limit,
            bound=bound,
            starts=1,
            seed=seed,
            guess=point.coefficients,
        )
        provenance = replace(
            polished.provenance,
            method=f"{method}, polished by ipopt",
            settings={**settings, **polished.provenance.settings},
            seconds=front.seconds + polished.provenance.seconds,
        )
        return replace(polished, provenance=provenance)
    found = evaluate_coefficients(task, point.coefficients, method=method, settings=settings)
    return replace(found, provenance=replace(found.provenance, seconds=front.seconds))


def run_front(
    task: PointToPoint,
    options: dict[str, Any],
    output: Path | None,
    figure: Path | None,
    quiet: bool,
) -> list[Path]:
    """Search, show what was found, and write it; return the files written."""
    runs, workers = options.pop("runs"), options.pop("workers")
    method, terms = options.pop("method"), options.pop("terms")
    checkpoint, resume = options.pop("checkpoint"), options.pop("resume")
    profile = CycloidPolynomial(terms)
    targets = _targets(output, options["seed"], runs)
    error_console, console = Console(stderr=True), Console()
    if workers > (os.cpu_count() or 1):
        error_console.print(f"{workers} workers on {os.cpu_count()} cores: they will share them")
    if runs == 1:
        with search_display(error_console, quiet=quiet) as report:
            fronts = [
                search(
                    task, method, profile=profile, checkpoint=checkpoint, resume=resume,
                    report=report, **options,
                )
            ]  # fmt: skip
    else:
        if checkpoint or resume:
            raise ValueError("--checkpoint and --resume are for one run, not with --runs")
        fronts = search_many(
            task, method, runs, workers=workers, profile=profile,
            done=lambda front: None if quiet else _show_run(error_console, front), **options,
        )  # fmt: skip
    if not any(front.points for front in fronts):
        if not all(front.complete for front in fronts) or len(fronts) < runs:
            raise KeyboardInterrupt
        raise SolverFailedError(
            f"{method} found no candidate that meets the task; widen its limits or the bound, or "
            "search longer"
        )
    if len(fronts) < runs:
        error_console.print(f"interrupted: {len(fronts)} of {runs} seeds are done")
    _show(console, fronts)
    written: list[Path] = []
    for front in fronts:
        if output is not None:
            front.save(targets[front.seed or 0])
            written.append(targets[front.seed or 0])
    if figure is not None:
        title = f"{method}, {task.plant.name}, {len(fronts)} seed{'s' * (len(fronts) > 1)}"
        save_figure(front_figure(fronts, title), figure)
        written.append(figure)
    return written


def _targets(output: Path | None, seed: int, runs: int) -> dict[int, Path]:
    if output is None:
        return {}
    if runs == 1:
        return {seed: output}
    names = {s: output.with_stem(f"{output.stem}-seed{s}") for s in range(seed, seed + runs)}
    return {s: check_writable(path) for s, path in names.items()}


def _show_run(console: Console, front: Front) -> None:
    share = front.history[-1].hypervolume if front.history else 0.0
    console.print(
        f"seed {front.seed}: hypervolume {share:.4f} in {front.seconds:.1f} s",
        highlight=False,
    )


def _show(console: Console, fronts: Sequence[Front]) -> None:
    for front in fronts:
        _show_front(console, front)
    if len(fronts) > 1:
        volume, energy = hypervolumes(fronts), energies_at(fronts)
        console.print(
            f"hypervolume: median {volume.median:.4f}, quartiles {volume.lower:.4f} to "
            f"{volume.upper:.4f}\nenergy at {STILL * 1e3:g} mm: median {energy.median:.4g} J, "
            f"quartiles {energy.lower:.4g} to {energy.upper:.4g} J",
            highlight=False,
        )


def _show_front(console: Console, front: Front) -> None:
    state = "" if front.complete else " (interrupted: what was found until then)"
    lines = [
        f"{front.method}, seed {front.seed}: {len(front.points)} points, "
        f"{front.evaluations} candidates in {front.seconds:.1f} s, {front.failed} failed{state}"
    ]
    if front.points:
        chosen = {"stillest": front.stillest(), "knee": front.knee(), "cheapest": front.cheapest()}
        lines += [
            f"  {name:9}{point.energy:.4g} J at {point.residual * 1e3:.3g} mm"
            for name, point in chosen.items()
        ]
    console.print("\n".join(lines), highlight=False)
