"""Run a metaheuristic on a task: report, checkpoint, resume, and return a front."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.metaheuristics.algorithms.presets import PAPER_BOX, preset_of
from quietarm.metaheuristics.runs.progress import Report
from quietarm.metaheuristics.runs.settings import (
    SearchSettings,
    SearchSpec,
    number_of_individuals,
)
from quietarm.ocp import CycloidPolynomial, Front, JointProfile, PointToPoint
from quietarm.ocp.files import check_writable
from quietarm.ocp.interrupts import note_interrupts

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm


def _warn(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=3)


def search(
    task: PointToPoint,
    algorithm: str | Algorithm = "nsga2",
    *,
    profile: JointProfile | None = None,
    bound: float | None = None,
    population: int | None = None,
    generations: int | None = None,
    evaluations: int | None = None,
    settings: Mapping[str, object] | None = None,
    seed: int = 0,
    threads: int = 1,
    checkpoint: str | Path | None = None,
    resume: str | Path | None = None,
    report: Report = lambda progress: None,
    found: Callable[[Front], None] | None = None,
    warn: Callable[[str], None] = _warn,
) -> Front:
    """Search the trade-off between residual and energy without derivatives.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    algorithm : str or pymoo Algorithm
        A name of `PRESETS`: ``"nsga2"`` and ``"vepso"`` have the paper's settings, the others
        pymoo's. Or any multi-objective algorithm of pymoo that was not run yet; it is copied, so
        the one given stays as it is.
    profile : JointProfile, optional
        How the joint moves; the cycloid of a polynomial of six terms by default.
    bound : float
        Largest absolute coefficient; required, unless the profile has a `default_bound`.
    population, generations : int, optional
        Individuals (particles in a swarm) and generations; those of the preset by default. With
        an algorithm of your own its population counts, and generations are required.
    evaluations : int, optional
        Candidates in all, in place of generations: as many whole generations as they suffice for.
    settings : mapping, optional
        What else a method known by name is set to, as ``{"crossover": 0.7}``; `Preset.settings`
        says what it has.
    seed : int
        Seed of the random numbers.
    threads : int
        Blocks of the population that are evaluated at the same time.
    checkpoint : path, optional
        File to keep the search in, every few seconds.
    resume : path, optional
        Checkpoint to go on from, of the same search and the same versions: what is in it is done
        again without computing its figures.
    report : callable, optional
        Called with a `SearchProgress` after every generation.
    found : callable, optional
        Called with the front so far after the first generation and every second or so, for whom the
        search itself may be lost; its ``complete`` is false.
    warn : callable, optional
        Called with a message when evaluations suffice for few generations, or the last checkpoint
        could not be written, which do not stop the search; by default it becomes a RuntimeWarning.

    Returns
    -------
    Front
        The points found, with figures of a finer rollout. After Ctrl-C what was found until then,
        with ``complete`` false.

    Raises
    ------
    ValueError
        When an argument is out of range or missing, or the checkpoint is of another search.
    FileFormatError
        When the file to resume from is not a whole checkpoint.
    """
    # Not at the top: pymoo takes longer to load than all of quietarm, and only a search needs it.
    from quietarm.metaheuristics.objective.population import PopulationObjective
    from quietarm.metaheuristics.objective.problem import MoveProblem
    from quietarm.metaheuristics.runs.checkpoint import Keeper, KeptProblem, load_checkpoint
    from quietarm.metaheuristics.runs.front import front_of, handing_over
    from quietarm.metaheuristics.runs.loop import Loop

    profile = CycloidPolynomial() if profile is None else profile
    bound = profile.default_bound if bound is None else bound
    if evaluations is not None:
        generations = _generations(algorithm, population, generations, evaluations, warn)
    given = population, generations, settings
    method, chosen, population, generations, own = (
        _known(algorithm, task, *given) if isinstance(algorithm, str) else _own(algorithm, *given)
    )
    if bound is None:
        papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
        raise ValueError(
            f"{method} searches a box: give a bound on the coefficients (the paper used {papers})"
        )
    asked = SearchSettings(bound, population, generations)
    spec = SearchSpec(task, profile, method, asked, seed, own)
    objective = PopulationObjective(task, profile, threads=threads)
    problem, keeper, known = MoveProblem(objective, asked.bound), None, None
    if checkpoint is not None or resume is not None:
        known = None if resume is None else load_checkpoint(resume, spec)
        problem = KeptProblem(objective, asked.bound, known)
        if checkpoint is not None:
            keeper = Keeper(spec, problem, check_writable(checkpoint))
    loop = Loop(spec, chosen, problem, known.seconds if known else 0.0)
    # From here on Ctrl-C ends the search after the current generation and does nothing else: the
    # checkpoint holds whole generations, and the front is worked out to the end.
    reports = [report] if keeper is None else [report, keeper.after_generation]
    if found is not None:  # before the report, so that what is heard of can be kept
        reports.insert(0, handing_over(loop, found))
    with note_interrupts() as interrupts:
        loop.run(interrupts, *reports)
        trouble = keeper.write(loop.seconds) if keeper and loop.history else ""
        front = front_of(loop)
    if trouble:
        warn(f"the end of the search is in no checkpoint: {trouble}")
    return replace(front, complete=not interrupts)


def _generations(
    algorithm: str | Algorithm,
    population: int | None,
    generations: int | None,
    evaluations: int,
    warn: Callable[[str], None],
) -> int:
    """As many generations as evaluations suffice for."""
    if generations is not None:
        raise ValueError("evaluations stand in place of generations; leave one of them out")
    if not isinstance(algorithm, str):
        raise ValueError("evaluations are for a method known by name; give generations")
    preset = preset_of(algorithm)
    if few := preset.too_few(evaluations, population):
        warn(few)
    return preset.generations_for(evaluations, population)


_Chosen = tuple[str, "Algorithm", int | None, int, Mapping[str, object]]
"""Name, algorithm, population, generations, and its own settings, defaults as well."""


def _known(
    name: str,
    task: PointToPoint,
    population: int | None,
    generations: int | None,
    settings: Mapping[str, object] | None,
) -> _Chosen:
    preset = preset_of(name)
    if task.limits and not preset.keeps_limits:
        raise ValueError(
            f"{preset.name} cannot search a task with limits; choose another method, or leave "
            "the limits out"
        )
    population = number_of_individuals(preset.population if population is None else population)
    generations = preset.generations if generations is None else generations
    chosen, own = preset.build(population, settings), preset.checked(population, settings)
    return preset.name, chosen, population, generations, own


def _own(
    algorithm: Algorithm,
    population: int | None,
    generations: int | None,
    settings: Mapping[str, object] | None,
) -> _Chosen:
    from quietarm.metaheuristics.algorithms.own import own_algorithm
    from quietarm.metaheuristics.algorithms.provenance import settings_of

    chosen = own_algorithm(algorithm)
    method = type(chosen).__name__
    for name, value in (("population", population), ("settings", settings)):
        if value:
            raise ValueError(f"{name} is set in the algorithm that you give, not beside it")
    if generations is None:
        raise ValueError(f"give the number of generations for {method}")
    return method, chosen, None, generations, settings_of(chosen)
