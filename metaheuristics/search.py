"""Run a metaheuristic on a task: report, checkpoint, resume, and return a front."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pymoo.core.algorithm import Algorithm

from metaheuristics.algorithms.nsga2 import PaperNSGA2
from metaheuristics.algorithms.presets import PAPER_BOX, PRESETS
from metaheuristics.algorithms.vepso import VEPSO
from metaheuristics.runs.run import Run, SearchProgress
from ocp import CycloidPolynomial, JointProfile, PointToPoint
from ocp.checks import whole
from ocp.files import check_writable
from ocp.front import Front
from ocp.interrupts import note_interrupts
from ocp.provenance import coefficient_bound


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
    seed: int = 0,
    threads: int = 1,
    checkpoint: str | Path | None = None,
    resume: str | Path | None = None,
    report: Callable[[SearchProgress], None] = lambda progress: None,
    warn: Callable[[str], None] = _warn,
) -> Front:
    """Search the trade-off between residual and energy without derivatives.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    algorithm : str or pymoo Algorithm
        ``"nsga2"`` or ``"vepso"`` with the paper's settings, or any multi-objective algorithm of
        pymoo that was not run yet; it is copied, so the one given stays as it is.
    profile : JointProfile, optional
        How the joint moves; the cycloid of a polynomial of six terms by default.
    bound : float
        Largest absolute coefficient; required.
    population, generations : int, optional
        Individuals (particles a swarm) and generations; those of the paper by default. With an
        algorithm of your own its population counts, and generations are required.
    seed : int
        Seed of the random numbers.
    threads : int
        Blocks of the population that are evaluated at the same time.
    checkpoint : path, optional
        File to write the state to every few seconds; for ``"nsga2"`` and ``"vepso"``.
    resume : path, optional
        Checkpoint to go on from, of the same search and the same versions.
    report : callable, optional
        Called with a `SearchProgress` after every generation.
    warn : callable, optional
        Called with a line when the last checkpoint could not be written, which stops no search;
        by default it becomes a RuntimeWarning.

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
    profile = CycloidPolynomial() if profile is None else profile
    run = _prepare(task, algorithm, profile, bound, population, generations, seed, threads)
    if (checkpoint or resume) and not run.resumable:
        raise ValueError(f"checkpoints are for nsga2 and vepso, not for {run.method}")
    if checkpoint is not None:
        check_writable(checkpoint)
    if resume is not None:
        run.resume(resume)
    # From here on Ctrl-C ends the search after the generation that it comes in, and nothing else:
    # what is kept is a whole generation, and what was found is not lost in working out the front.
    with note_interrupts() as interrupts:
        trouble = run.go(checkpoint, report, interrupts)
        front = run.front()
    if trouble:
        warn(f"the end of the search is in no checkpoint: {trouble}")
    return replace(front, complete=not interrupts)


def _prepare(
    task: PointToPoint,
    algorithm: str | Algorithm,
    profile: JointProfile,
    bound: float | None,
    population: int | None,
    generations: int | None,
    seed: int,
    threads: int,
) -> Run:
    """Check the arguments of `search`."""
    if not isinstance(task, PointToPoint):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"task is {task!r}; give a PointToPoint")
    if not isinstance(profile, JointProfile):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"profile is {profile!r}; give a JointProfile, as CycloidPolynomial(6)")
    method = _checked_name(algorithm)
    if bound is None:
        papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
        raise ValueError(
            f"{method} searches a box: give a bound on the coefficients (the paper used {papers})"
        )
    bound = coefficient_bound(bound)
    if isinstance(algorithm, str):
        preset = PRESETS[method]
        # a crossing takes a pair, and a swarm of one has nobody to learn from
        population = whole("population", preset.population if population is None else population, 2)
        generations = preset.generations if generations is None else generations
        chosen = VEPSO(population) if method == "vepso" else PaperNSGA2(population)
    else:
        if population is not None:
            raise ValueError("population is set in the algorithm that you give, not beside it")
        if generations is None:
            raise ValueError(f"give the number of generations for {method}")
        chosen = copy.deepcopy(algorithm)  # as it was given, to be given again
    generations, seed = whole("generations", generations, 1), whole("seed", seed, 0)
    if profile.size == 0:
        raise ValueError("a profile of 0 terms has nothing to choose; give 1 term or more")
    settings = {"bound": bound, "population": population, "generations": generations}
    return Run(task, profile, chosen, method, settings, seed, threads)


def _checked_name(algorithm: str | Algorithm) -> str:
    """The name of a method that can search a trade-off; ValueError where it cannot."""
    if isinstance(algorithm, str):
        if algorithm not in PRESETS:
            raise ValueError(f"unknown method {algorithm!r}; give one of {', '.join(PRESETS)}")
        return algorithm
    if not isinstance(algorithm, Algorithm):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(
            f"algorithm is {algorithm!r}; give {', '.join(PRESETS)} or an instance of one of "
            "pymoo's algorithms"
        )
    name = type(algorithm).__name__
    # pymoo says nowhere else how many objectives an algorithm is for, and some would run on
    if any(kind.__module__.startswith("pymoo.algorithms.soo") for kind in type(algorithm).__mro__):
        raise ValueError(
            f"{name} minimises one objective, and a move has two; give a multi-objective "
            "algorithm, as those of pymoo.algorithms.moo"
        )
    if algorithm.problem is not None or algorithm.is_initialized:
        raise ValueError(f"this {name} was set up or run before; give a new one")
    return name
