"""The floor: the least energy of a move over all joint motions, not only polynomials."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import CountFromOne, Positive, positive, takes, whole
from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.floor.program import FloorProgram, FreeSolution, finer, first_grid
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import Limit
from quietarm.ocp.motion_answer import MotionAnswer
from quietarm.ocp.planning.best_of_starts import SAME
from quietarm.ocp.planning.certify import excess_error, tighten
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.planning.remedies import least_peaks, true_peaks, unmet
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.record import Record, Verification, number_of_starts
from quietarm.ocp.rest import rest_of
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.ocp.solvers.choice import as_part
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

FIRST_PLAN = "first_plan"
"""What a record calls the solver of the plan that is one of the starts."""
FIRST_INTERVALS = 80
MOST_FIRST_INTERVALS = 1500
MOST_INTERVALS = 6000
"""Most intervals of the first grid, and of any finer one."""


@dataclass(frozen=True)
class Level:
    """One grid of the refinement."""

    steps: CountFromOne
    energy: float


@dataclass(frozen=True)
class Floor(MotionAnswer):
    """The best motion found without a parametrisation, at rest on arrival or as the task asks.

    Its energy is an upper estimate of the least energy of all motions. `discretisation_error`
    estimates how far finer grids would lower it; a better local minimum far from all starts may
    exist.

    Attributes
    ----------
    free : FreeMotion
        How the joint moves.
    levels : tuple of Level
        The grids, coarse to fine. The motion is that of the last, or of a coarser one if that has a
        lower energy.
    starts : tuple of float
        Energy [J] at which each solved start ended, all on the second grid.
    solver_energy : float
        Energy [J] that the solver gave the motion, by which `verification` compares.
    tolerance : float
        Share of the energy by which the last two grids were to differ at most.
    """

    kind: ClassVar[str] = "floor"
    version: ClassVar[int] = 4
    read_by_2_0 = (3,)
    first_order: ClassVar[float] = 0.5
    """Ratio of successive falls of the energy where the error is proportional to the intervals'
    length; it is 1/4 where to its square."""
    most_ratio: ClassVar[float] = 0.8
    """Ratio above which they are not taken for a converging series."""

    task: PointToPoint
    free: FreeMotion
    levels: tuple[Level, ...]
    starts: tuple[float, ...]
    status: SolveStatus
    solver_energy: float
    tolerance: Positive
    record: Record

    def __post_init__(self) -> None:
        end = self.free.times[-1]
        duration = self.task.duration
        if not math.isclose(end, duration, rel_tol=1e-12):
            raise ValueError(f"its times end at {end:g} s, not at the duration {duration:g} s")
        if len(self.levels) < 2 or not self.starts:
            raise ValueError("it has fewer than two levels, or no start")

    @classmethod
    def _decided_before(cls, verification: Verification) -> dict[str, Any]:
        return {"solver_energy": verification.fixed_step_energy}

    @cached_property
    def verification(self) -> Verification:
        """Distance of the solver's figures, on its intervals, from those by CVODES."""
        return Verification.between(
            self.free.steps, self.solver_energy, 0.0, self.figures, rest_of(self.task)
        )

    @property
    def smooth(self) -> bool:
        """Return whether the acceleration is continuous."""
        return bool(np.any(self.free.jerk))

    @property
    def change(self) -> float:
        """Decrease of the energy from the last but one grid to the last [J]; may be negative."""
        return self.levels[-2].energy - self.levels[-1].energy

    @property
    def settled(self) -> bool:
        """Return whether the last grids agree within the tolerance; else refinement ended early."""
        return abs(self.change) <= self.tolerance * self.levels[-1].energy

    @property
    def ratio(self) -> float | None:
        """The last decrease of the energy over the one before; None if there are not two."""
        falls = [coarse.energy - fine.energy for coarse, fine in pairwise(self.levels)]
        if len(falls) < 2 or min(falls[-2:]) <= 0:
            return None
        return falls[-1] / falls[-2]

    @property
    def discretisation_error(self) -> float:
        """Estimate of how far ever finer grids would lower the energy [J]; it is no bound.

        The last decrease is continued as a geometric series, by the ratio of the last two but at
        least 1/2, and the quadrature error of the solver is added. A pulse of acceleration takes
        up to 4e-5 of the move on every grid, which costs about 1e-4 of the energy and is neglected.
        Where a coarser grid has a lower energy than the last, the solver has changed to another
        local minimum: then the larger of the decrease and the increase is an order of magnitude.
        """
        energies = [level.energy for level in self.levels]
        lowest = energies.index(min(energies))
        missed = max(-self.verification.energy_difference, 0.0)
        if energies[lowest] < energies[-1]:
            highest = max(energies[max(lowest - 1, 0) :])
            return highest - energies[lowest] + missed
        ratio = min(max(self.ratio or 0.0, self.first_order), self.most_ratio)
        return self.change * ratio / (1 - ratio) + missed

    def agreeing(self, share: float = 0.005) -> int:
        """Number of starts that ended within a share of the best of them."""
        return sum(energy <= min(self.starts) * (1 + share) for energy in self.starts)

    @cached_property
    def candidate(self) -> JudgedMotion:
        """The motion on the nominal plant, evaluated by CVODES."""
        return JudgedMotion.of_free_motion(self.task.certain, self.free)

    @property
    def trajectory(self) -> Trajectory:
        """The move and the residual window by CVODES; where the torque jumps, two at a time."""
        return self.candidate.trajectory


@takes(task=PointToPoint, solver=Solver)
def energy_floor(
    task: PointToPoint,
    *,
    smooth: bool = False,
    starts: int = 4,
    seed: int = 0,
    solver: Solver = Sqp(),
    energy_tolerance: float = 0.005,
) -> Floor:
    """Find the best motion without a parametrisation: an upper estimate of the least energy.

    The acceleration of the joint is a decision variable on every interval of a grid, or its jerk
    for a smooth motion. The grid is refined where the acceleration has short pulses.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    smooth : bool
        Whether the acceleration is continuous, and zero at both ends.
    starts, seed : int
        How many starts: the plain cycloid, the plan of six terms, then random motions of the seed.
    solver : Solver
        What plans the six terms. The floor itself is by IPOPT, with the options of this solver; its
        tolerance is ten times larger.
    energy_tolerance : float
        Relative change of the energy at which the refinement of the grid ends.

    Returns
    -------
    Floor
        The motion, with values by CVODES.

    Raises
    ------
    ValueError
        When an argument is out of range, or the move takes too many periods of the fastest mode.
    InfeasibleTaskError
        When no motion satisfies the limits; the text says what would be feasible.
    SolverFailedError
        When no start ended at an optimum for another reason.
    """
    began = time.perf_counter()
    starts = number_of_starts(starts)
    seed = whole("seed", seed, 0)
    tolerance = positive("energy tolerance", energy_tolerance)
    program = FloorProgram(task, smooth, solver)
    solved = _solve_from_starts(program, _paths(task, starts, seed, solver))
    improved = _refine_each(program, solved)
    levels = [_cheapest(solved), _cheapest(improved)]
    _refine(program, levels, tolerance)
    solution, candidate = _certify_least(program, levels)
    first_plan = as_part(FIRST_PLAN, solver.stated) if starts > 1 else {}
    method = f"ipopt, free {'jerk' if smooth else 'acceleration'}"
    floor = Floor(
        task=task,
        free=solution.free,
        levels=tuple(Level(level.free.steps, level.energy) for level in levels),
        starts=tuple(solution.energy for solution in improved),
        status=solution.status,
        solver_energy=solution.energy,
        tolerance=tolerance,
        record=Record(
            method,
            {"starts": starts, **program.solver.stated, **first_plan},
            seed=seed,
            seconds=time.perf_counter() - began,
        ),
    )
    return floor.with_candidate(candidate)


def _cheapest(solutions: Iterable[FreeSolution]) -> FreeSolution:
    return min(solutions, key=lambda solution: solution.energy)


def _first_fractions(task: PointToPoint) -> NDArray[np.float64]:
    steps = default_steps(task, least=FIRST_INTERVALS)
    if steps > MOST_FIRST_INTERVALS:
        raise ValueError(
            f"duration {task.duration:g} s takes {steps} intervals of the plant's fastest mode; "
            f"a floor begins with up to {MOST_FIRST_INTERVALS}: give a shorter duration"
        )
    return first_grid(steps)


def _paths(task: PointToPoint, starts: int, seed: int, solver: Solver) -> Iterator[JointPath]:
    """Motions to start from: plain cycloid, the plan of six terms, random ones."""
    profile = CycloidPolynomial()
    random = np.random.default_rng(seed)
    guesses = [random.uniform(*profile.start_box(None)) for _ in range(starts)]
    guesses[0] = profile.plain
    if starts > 1:
        with suppress(SolverFailedError):  # other motions than polynomials may keep the limits
            plan = plan_move(task.certain, profile, starts=1, solver=solver)
            guesses[1] = np.array(plan.coefficients)
    return (profile.path(coefficients, *task.move) for coefficients in guesses)


def _solve_from_starts(program: FloorProgram, paths: Iterable[JointPath]) -> list[FreeSolution]:
    """The solutions from all starts; where there are none, from motions of least peaks."""
    limits = program.task.limits
    fractions = _first_fractions(program.task)
    guesses = [program.along(path, fractions) for path in paths]
    tried = [program.solve(free, limits) for free in guesses]
    solved = _solved(tried)
    if solved:
        return solved

    def solve_least(remaining: Sequence[Limit], name: str) -> list[FreeSolution]:
        return [program.solve(solution.free, remaining, name) for solution in tried[:2]]

    least = least_peaks(limits, solve_least)
    within = [
        least[limit.name].free
        for limit in limits
        if limit.name in least and limit.keeps(least[limit.name].peaks[limit.name])
    ]
    tried = [*tried, *(program.solve(free, limits) for free in within)]
    solved = _solved(tried)
    if solved:
        return solved
    peaks = true_peaks(limits, least, lambda solution: _by_cvodes(program, solution))
    raise unmet(
        program.task,
        limits,
        tried,
        peaks,
        motion="motion at all",
        remedy="a longer duration",
        otherwise="try another seed, more starts or a longer duration.",
    )


def _solved(solutions: Iterable[FreeSolution]) -> list[FreeSolution]:
    return [solution for solution in solutions if solution.status.solved]


def _by_cvodes(program: FloorProgram, solution: FreeSolution) -> JudgedMotion:
    """The motion on the nominal plant, for CVODES."""
    return JudgedMotion.of_free_motion(program.task.certain, solution.free)


def _refine_each(program: FloorProgram, solutions: list[FreeSolution]) -> list[FreeSolution]:
    """Every solution on its next grid, or as it was; of equal energies one is solved."""
    refined: list[tuple[FreeSolution, FreeSolution]] = []
    for solution in solutions:
        same = (
            fine for coarse, fine in refined if abs(coarse.energy / solution.energy - 1) <= SAME
        )
        fine = next(same, None) or _on_finer_grid(program, solution)
        refined.append((solution, fine if fine.status.solved else solution))
    return [fine for _, fine in refined]


def _refine(
    program: FloorProgram, levels: list[FreeSolution], tolerance: float, least_levels: int = 3
) -> None:
    """Append finer grids until the energy settles, a solve fails or the grid is the finest.

    Two falls of the energy at least show whether they become smaller, and how fast.
    """
    while 2 * levels[-1].free.steps <= MOST_INTERVALS:
        fall = levels[-2].energy - levels[-1].energy
        if len(levels) >= least_levels and abs(fall) <= tolerance * levels[-1].energy:
            return
        following = _on_finer_grid(program, levels[-1])
        if not following.status.solved:
            return
        levels.append(following)


def _on_finer_grid(
    program: FloorProgram, solution: FreeSolution, most_cold: int = 600
) -> FreeSolution:
    """The solution on the next grid, warm, or cold where that fails and the grid is coarse.

    A coarse grid has up to `most_cold` intervals.
    """
    limits = program.task.limits
    free = finer(solution.free)
    warm = program.solve(free, limits, warm=True)
    if warm.status.solved or free.steps > most_cold:
        return warm
    return program.solve(free, limits)


def _certify_least(
    program: FloorProgram, levels: list[FreeSolution]
) -> tuple[FreeSolution, JudgedMotion]:
    """The last grid's motion, or that of a coarser grid where it is verified to need less."""
    least = _certify(program, levels[-1])
    for level in levels[:-1]:
        if level.energy < levels[-1].energy:
            with suppress(SolverFailedError):  # a coarse grid may not keep the limits in between
                certified = _certify(program, level)
                least = min(least, certified, key=lambda pair: pair[1].energy)
    return least


def _certify(
    program: FloorProgram, solution: FreeSolution, rounds: int = 4, tolerated: float = 1e-6
) -> tuple[FreeSolution, JudgedMotion]:
    """Compare with CVODES; tighten limits that are exceeded between the solver's nodes.

    There are so many `rounds` of it; a peak may pass its limit by the share that is tolerated.
    """
    limits = program.task.limits
    tightened = limits
    candidate = _by_cvodes(program, solution)
    for _ in range(rounds):
        if not candidate.figures.exceeded(limits, tolerated):
            break
        tightened = tighten(tightened, candidate.figures, limits)
        following = program.solve(solution.free, tightened, warm=True)
        if not following.status.solved:
            break
        solution = following
        candidate = _by_cvodes(program, solution)
    remedy = "the grid is too coarse for this motion; give a smaller energy tolerance"
    error = excess_error(candidate.figures, limits, remedy)
    if error is not None:
        raise error
    return solution, candidate
