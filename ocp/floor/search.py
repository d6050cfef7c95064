"""The floor: the least energy of a move over all joint motions, not only polynomials."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import suppress
from operator import attrgetter

import numpy as np
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.floor.answer import Floor, FloorSettings, Level
from quietarm.ocp.floor.program import FloorProgram, FreeSolution, finer, first_grid
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.planning.certify import refuse_exceeded, tighten
from quietarm.ocp.planning.feasibility import keeps, least_peaks, true_peaks, unmet
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.record import Provenance, Verification
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.task import PointToPoint

FIRST_INTERVALS = 80
MOST_FIRST_INTERVALS, MOST_INTERVALS = 1500, 6000
"""Most intervals of the first grid, and of any finer one."""
_MOST_COLD = 600
"""After a failed warm solve a cold one is tried on grids of up to this many intervals."""
_LEAST_LEVELS = 3
"""Two falls of the energy at least, to see whether they become smaller, and how fast."""
_SAME = 1e-5
"""Solutions whose energies differ by less than this share are refined once."""
_ENERGY = attrgetter("energy")
_ROUNDS, _KEPT = 4, 1e-6
"""Rounds of tightening, and the share by which a verified peak may pass its limit without one."""


@one_at_a_time
def energy_floor(
    task: PointToPoint,
    *,
    smooth: bool = False,
    starts: int = 4,
    seed: int = 0,
    tolerance: float = 0.005,
) -> Floor:
    """Find the least energy with which any joint motion does a move and arrives at rest.

    The acceleration of the joint is free on every interval of a grid (piecewise constant), or its
    jerk for a smooth motion (acceleration continuous, and zero at both ends). The joint is at rest
    at both ends, and the modes are as the task says. The grid is refined until the energy changes
    by less than the tolerance.

    Where the solver fails on a finer grid, the refinement ends there and the floor says so. Where
    the energy rises on a finer grid, having gone to another minimum, the motion of the grid whose
    energy is least by the independent integrator is returned.

    Without an acceleration limit the least energy is approached by motions whose speed jumps: an
    impulse at either end, and on the single-link manipulator others on the way. The grid is finer
    where it finds them; the estimate of what is left says how far off the limit is. A smooth motion
    approaches the same limit; on as many intervals its energy may be slightly higher or lower.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    smooth : bool
        Whether the acceleration is continuous.
    starts : int
        How many starts: the plain cycloid, the plan of six terms, then random motions.
    seed : int
        Seed of the random starts.
    tolerance : float
        Relative change of the energy at which the refinement stops.

    Returns
    -------
    Floor
        The motion, with the figures of an independent integrator.

    Raises
    ------
    ValueError
        When an argument is out of range, or the move takes too many periods of the fastest mode.
    InfeasibleTaskError
        When no motion meets the limits; the text says what would be feasible.
    SolverFailedError
        When no start ended at an optimum for another reason.
    """
    settings = FloorSettings(smooth, starts, seed, tolerance)
    began = time.perf_counter()
    program = FloorProgram(task, settings.smooth)
    fractions = first_grid(_first_steps(task))
    tried = [program.solve(program.along(path, fractions), task.limits)
             for path in _paths(task, settings)]  # fmt: skip
    solved = _solved(program, tried)
    improved = _refined_once(program, solved)
    grids = [min(solved, key=_ENERGY), min(improved, key=_ENERGY)]
    _refine(program, grids, settings.tolerance)
    best, simulation = _least_verified(program, grids)
    return Floor(
        task=task,
        free=best.free,
        motion=simulation.motion,
        levels=tuple(Level(found.free.steps, found.energy) for found in grids),
        starts=tuple(found.energy for found in improved),
        status=best.status,
        verification=Verification.between(best.free.steps, best.energy, 0.0, simulation.motion),
        provenance=Provenance(
            f"ipopt, free {'jerk' if smooth else 'acceleration'}",
            settings,
            seconds=time.perf_counter() - began,
        ),
    )


def _first_steps(task: PointToPoint) -> int:
    after_arrival(task)  # a window that is too long is refused before the solves, not after
    steps = default_steps(task, least=FIRST_INTERVALS)
    if steps > MOST_FIRST_INTERVALS:
        raise ValueError(
            f"duration {task.duration:g} s takes {steps} intervals of the plant's fastest mode; "
            f"a floor begins with up to {MOST_FIRST_INTERVALS}: give a shorter duration"
        )
    return steps


def _refine(program: FloorProgram, grids: list[FreeSolution], tolerance: float) -> None:
    """Append finer grids until the energy settles, a solve fails or the grid is the finest."""
    while not _settled(grids, tolerance) and 2 * grids[-1].free.steps <= MOST_INTERVALS:
        following = _refined(program, grids[-1])
        if not following.status.solved:
            return
        grids.append(following)


def _paths(task: PointToPoint, settings: FloorSettings) -> Iterator[JointPath]:
    """Motions to start from: plain cycloid, the plan of six terms, random ones."""
    random = np.random.default_rng(settings.seed)
    profile = CycloidPolynomial()
    for i in range(settings.starts):
        coefficients = random.uniform(*profile.start_box(None))
        if i == 0:
            coefficients = profile.plain
        elif i == 1:
            with suppress(SolverFailedError):  # other motions than polynomials may keep the limits
                plan = plan_move(task.certain, profile, starts=1)
                coefficients = np.array(plan.coefficients)
        yield profile.path(coefficients, *task.move)


def _solved(program: FloorProgram, tried: list[FreeSolution]) -> list[FreeSolution]:
    """The starts that were solved; InfeasibleTaskError or SolverFailedError where none was."""
    limits, least = program.task.limits, dict[str, FreeSolution]()
    if not any(found.status.solved for found in tried):
        least = least_peaks(
            limits,
            lambda others, name: [program.solve(one.free, others, name) for one in tried[:2]],
        )
        within = [one for name, one in least.items() if keeps(one.peaks[name], name, limits)]
        tried = [*tried, *(program.solve(one.free, limits) for one in within)]
    solved = [found for found in tried if found.status.solved]
    if not solved:
        peaks = true_peaks(least, lambda found: _judge(program, found))
        raise unmet(
            "motion at all", limits, tried, peaks, "a longer duration",
            otherwise="try another seed, more starts or a longer duration.",
        )  # fmt: skip
    return solved


def _settled(grids: list[FreeSolution], tolerance: float) -> bool:
    before, after = grids[-2].energy, grids[-1].energy
    return len(grids) >= _LEAST_LEVELS and abs(before - after) <= tolerance * after


def _refined(program: FloorProgram, found: FreeSolution) -> FreeSolution:
    """The solution on the next grid, warm, or cold where that fails and the grid is coarse."""
    free, limits = finer(found.free), program.task.limits
    warm = program.solve(free, limits, warm=True)
    if warm.status.solved or free.steps > _MOST_COLD:
        return warm
    return program.solve(free, limits)


def _refined_once(program: FloorProgram, solved: list[FreeSolution]) -> list[FreeSolution]:
    """Every solution on its next grid; solutions of equal energy are refined once."""
    refined: dict[float, FreeSolution] = {}
    for found in solved:
        if not any(abs(found.energy - energy) <= _SAME * energy for energy in refined):
            refined[found.energy] = _refined(program, found)
    results = [
        refined[min(refined, key=lambda energy, found=found: abs(energy - found.energy))]
        for found in solved
    ]
    return [
        after if after.status.solved else before
        for before, after in zip(solved, results, strict=True)
    ]


def _least_verified(
    program: FloorProgram, grids: list[FreeSolution]
) -> tuple[FreeSolution, Candidate]:
    """The last grid's motion, or that of a coarser grid where it is verified to need less."""
    least = _within_limits(program, grids[-1])
    for found in grids[:-1]:
        if found.energy < grids[-1].energy:
            with suppress(SolverFailedError):  # a coarse grid may not keep the limits in between
                least = min(least, _within_limits(program, found), key=lambda one: one[1].energy)
    return least


def _within_limits(program: FloorProgram, best: FreeSolution) -> tuple[FreeSolution, Candidate]:
    """Verify; tighten limits that are passed between the solver's nodes."""
    limits = program.task.limits
    used, simulated = dict(limits), _judge(program, best)
    for _ in range(_ROUNDS):
        if not simulated.exceeded(limits, _KEPT):
            break
        used = tighten(used, simulated, limits)
        again = program.solve(best.free, used, warm=True)
        if not again.status.solved:
            break
        best, simulated = again, _judge(program, again)
    remedy = "the grid is too coarse for this motion; give a smaller tolerance"
    refuse_exceeded(simulated, limits, remedy)
    return best, simulated


def _judge(program: FloorProgram, found: FreeSolution) -> Candidate:
    return Candidate.of_free_motion(program.task.certain, found.free)
