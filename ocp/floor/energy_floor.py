"""The floor: the least energy of a move over all joint motions, not only polynomials."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import CountFromOne, Positive, positive, takes, whole
from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.floor.program import FloorProgram, FreeSolution, finer, first_grid
from quietarm.ocp.motion_answer import MotionAnswer
from quietarm.ocp.planning.best_of_starts import SAME, Sought, least_peaks, true_peaks, unmet
from quietarm.ocp.planning.certify import excess_error, tighten
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.record import Record, Verification, number_of_starts
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

FIRST_INTERVALS = 80
MOST_FIRST_INTERVALS, MOST_INTERVALS = 1500, 6000
"""Most intervals of the first grid, and of any finer one."""
_MOST_COLD = 600
"""After a failed warm solve a cold one is tried on grids of up to this many intervals."""
_LEAST_LEVELS = 3
"""Two falls of the energy at least, to see whether they become smaller, and how fast."""
_ROUNDS, _KEPT = 4, 1e-6
"""Rounds of tightening, and the share by which a verified peak may pass its limit without one."""
_by_energy = attrgetter("energy")
_FIRST_ORDER, _MOST_RATIO = 0.5, 0.8
"""Ratios of successive falls of the energy: where the error is proportional to the intervals'
length (1/4 to its square), and above which they are not taken for a converging series."""


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
    earlier: ClassVar[tuple[int, ...]] = (3,)

    task: PointToPoint
    free: FreeMotion
    levels: tuple[Level, ...]
    starts: tuple[float, ...]
    status: SolveStatus
    solver_energy: float
    tolerance: Positive
    record: Record

    def __post_init__(self) -> None:
        end, duration = self.free.times[-1], self.task.duration
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
        return Verification.between(self.free.steps, self.solver_energy, 0.0, self.motion)

    @property
    def smooth(self) -> bool:
        """Whether the acceleration is continuous."""
        return bool(np.any(self.free.jerk))

    @property
    def change(self) -> float:
        """Decrease of the energy from the last but one grid to the last [J]; may be negative."""
        return self.levels[-2].energy - self.levels[-1].energy

    @property
    def settled(self) -> bool:
        """Whether this is within the tolerance; otherwise the refinement ended early."""
        return abs(self.change) <= self.tolerance * self.levels[-1].energy

    @property
    def ratio(self) -> float | None:
        """The last decrease of the energy over the one before; None if there are not two."""
        falls = [one.energy - other.energy for one, other in pairwise(self.levels)][-2:]
        return falls[1] / falls[0] if len(falls) == 2 and min(falls) > 0 else None

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
            return max(energies[max(lowest - 1, 0) :]) - energies[lowest] + missed
        ratio = min(max(self.ratio or 0.0, _FIRST_ORDER), _MOST_RATIO)
        return self.change * ratio / (1 - ratio) + missed

    def agreeing(self, share: float = 0.005) -> int:
        """How many starts ended within a share of the best of them."""
        return sum(energy <= min(self.starts) * (1 + share) for energy in self.starts)

    @cached_property
    def candidate(self) -> Candidate:
        """The motion on the nominal plant, evaluated by CVODES."""
        return Candidate.of_free_motion(self.task.certain, self.free)

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
    starts, seed = number_of_starts(starts), whole("seed", seed, 0)
    tolerance = positive("energy tolerance", energy_tolerance)
    began = time.perf_counter()
    program = FloorProgram(task, smooth, solver)
    solved = _solve_from_starts(program, _paths(task, starts, seed, solver))
    improved = _refine_each(program, solved)
    levels = [min(solved, key=_by_energy), min(improved, key=_by_energy)]
    _refine(program, levels, tolerance)
    best, motion = _certify_least(program, levels)
    method = f"ipopt, free {'jerk' if smooth else 'acceleration'}"
    floor = Floor(
        task=task,
        free=best.free,
        levels=tuple(Level(found.free.steps, found.energy) for found in levels),
        starts=tuple(found.energy for found in improved),
        status=best.status,
        solver_energy=best.energy,
        tolerance=tolerance,
        record=_record(method, starts, seed, solver, time.perf_counter() - began),
    )
    return floor.with_candidate(motion)


def _record(method: str, starts: int, seed: int, solver: Solver, seconds: float) -> Record:
    """What found a floor; of its solver what is not the default."""
    options = {} if solver.stated == Sqp().stated else solver.stated
    return Record(method, {"starts": starts, **options}, None, seed, seconds=seconds)


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
    random, profile = np.random.default_rng(seed), CycloidPolynomial()
    drawn = [random.uniform(*profile.start_box(None)) for _ in range(starts)]
    drawn[0] = profile.plain
    if starts > 1:
        with suppress(SolverFailedError):  # other motions than polynomials may keep the limits
            plan = plan_move(task.certain, profile, starts=1, solver=solver)
            drawn[1] = np.array(plan.coefficients)
    return (profile.path(coefficients, *task.move) for coefficients in drawn)


def _solve_from_starts(program: FloorProgram, paths: Iterable[JointPath]) -> list[FreeSolution]:
    """The solutions from all starts; where there are none, from motions of least peaks."""
    task, limits = program.task, program.task.limits
    fractions = _first_fractions(task)
    guesses = [program.along(path, fractions) for path in paths]
    tried = [program.solve(free, limits) for free in guesses]
    least = dict[str, FreeSolution]()
    if not any(found.status.solved for found in tried):
        least = least_peaks(
            limits,
            lambda others, name: [program.solve(one.free, others, name) for one in tried[:2]],
        )
        within = [least[one.name].free for one in limits
                  if one.name in least and one.keeps(least[one.name].peaks[one.name])]  # fmt: skip
        tried += [program.solve(free, limits) for free in within]
    solved = [found for found in tried if found.status.solved]
    if not solved:
        peaks = true_peaks(
            limits, least, lambda found: Candidate.of_free_motion(task.certain, found.free)
        )
        sought = Sought(
            "motion at all",
            "a longer duration",
            otherwise="try another seed, more starts or a longer duration.",
        )
        raise unmet(sought, limits, tried, peaks)
    return solved


def _refine_each(program: FloorProgram, solved: list[FreeSolution]) -> list[FreeSolution]:
    """Every solution on its next grid, or as it was; of equal energies one is solved."""
    refined = list[tuple[FreeSolution, FreeSolution]]()
    for found in solved:
        equal = (new for old, new in refined if abs(old.energy / found.energy - 1) <= SAME)
        after = next(equal, None) or _on_finer_grid(program, found)
        refined.append((found, after if after.status.solved else found))
    return [after for _, after in refined]


def _refine(program: FloorProgram, levels: list[FreeSolution], tolerance: float) -> None:
    """Append finer grids until the energy settles, a solve fails or the grid is the finest."""
    while 2 * levels[-1].free.steps <= MOST_INTERVALS:
        fall = levels[-2].energy - levels[-1].energy
        if len(levels) >= _LEAST_LEVELS and abs(fall) <= tolerance * levels[-1].energy:
            return
        following = _on_finer_grid(program, levels[-1])
        if not following.status.solved:
            return
        levels.append(following)


def _on_finer_grid(program: FloorProgram, found: FreeSolution) -> FreeSolution:
    """The solution on the next grid, warm, or cold where that fails and the grid is coarse."""
    free, limits = finer(found.free), program.task.limits
    warm = program.solve(free, limits, warm=True)
    if warm.status.solved or free.steps > _MOST_COLD:
        return warm
    return program.solve(free, limits)


def _certify_least(
    program: FloorProgram, levels: list[FreeSolution]
) -> tuple[FreeSolution, Candidate]:
    """The last grid's motion, or that of a coarser grid where it is verified to need less."""
    least = _certify(program, levels[-1])
    for found in levels[:-1]:
        if found.energy < levels[-1].energy:
            with suppress(SolverFailedError):  # a coarse grid may not keep the limits in between
                least = min(least, _certify(program, found), key=lambda one: one[1].energy)
    return least


def _certify(program: FloorProgram, found: FreeSolution) -> tuple[FreeSolution, Candidate]:
    """Compare with CVODES; tighten limits that are exceeded between the solver's nodes."""
    task, limits = program.task.certain, program.task.limits
    motion, tightened = Candidate.of_free_motion(task, found.free), limits
    for _ in range(_ROUNDS):
        if not motion.exceeded(limits, _KEPT):
            break
        tightened = tighten(tightened, motion, limits)
        again = program.solve(found.free, tightened, warm=True)
        if not again.status.solved:
            break
        found, motion = again, Candidate.of_free_motion(task, again.free)
    remedy = "the grid is too coarse for this motion; give a smaller energy tolerance"
    if error := excess_error(motion, limits, remedy):
        raise error
    return found, motion
