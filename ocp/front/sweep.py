"""What the gradient's fronts have in common: one program, its two ends, points that are checked."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ocp.answers.provenance import SolveSettings
from ocp.base.errors import SolverFailedError
from ocp.base.interrupts import note_interrupts
from ocp.front.answer import Front, reference_corner
from ocp.front.points import FailedPoint, FrontPoint, non_dominated
from ocp.plan.feasibility import least_peaks
from ocp.plan.solver import first_steps, least_energy, start_coefficients
from ocp.plan.verification import ENOUGH_STEPS, MOST_STEPS, STILL, verified
from ocp.profiles.joint_profile import JointProfile
from ocp.program.solution import LEAST_ENERGY, Solution
from ocp.program.task_program import REACHES, TaskProgram
from ocp.program.transcription import RESIDUAL
from ocp.simulation.objective import Motion
from ocp.task.point_to_point import PointToPoint

RESIDUAL_LIMIT = "residual_limit"
Guess = NDArray[np.float64] | Solution
Report = Callable[[int, int], None]
"""Called with the number of points done and asked for."""
SAME = 1e-5
"""Energies that differ by less than this share are of one motion."""
_PATIENCE = 0.6
"""How long [s] points are still checked after Ctrl-C."""
_MORE_STEPS = 2
"""How many times the sweep's steps a point may take whose figures disagree."""
_SAMPLING = 1e-4
"""Share by which the residual between samples, or by CVODES, may pass that of the solver."""


def no_report(done: int, total: int) -> None:
    """Report nothing."""


@dataclass(frozen=True)
class Ends:
    """The ends of a front.

    Attributes
    ----------
    still : Solution
        Least energy at rest on arrival.
    still_point : FrontPoint or FailedPoint
        The same, checked.
    cheapest : Solution
        Least energy with any residual.
    """

    still: Solution
    still_point: FrontPoint | FailedPoint
    cheapest: Solution

    @property
    def width(self) -> float:
        """How far apart they are in the residual [m]."""
        return self.cheapest.residual - self.still.residual

    @property
    def height(self) -> float:
        """How far apart they are in the energy [J]."""
        return self.still.energy - self.cheapest.energy

    @property
    def are_one(self) -> bool:
        """Whether the cheapest motion is the still one, and there is no front between."""
        return self.width <= STILL or self.height <= SAME * self.still.energy


def better(one: Solution, other: Solution) -> bool:
    """Whether one solution is cheaper than another by more than the solver's tolerance."""
    if not (one.status.solved and other.status.solved):
        return one.status.solved
    return one.energy < other.energy * (1 - SAME)


@dataclass
class Sweep:
    """A task's program, asked again and again with other residual limits or weights.

    Attributes
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        Bound, starts, seed, steps.
    """

    task: PointToPoint
    profile: JointProfile
    settings: SolveSettings
    iterations: int = 0
    began: float = field(default_factory=time.perf_counter)

    def __post_init__(self) -> None:
        if self.profile.size == 0:
            raise ValueError("a profile of 0 terms has nothing to choose; give 1 term or more")
        self.steps = first_steps(self.task, self.profile, self.settings)
        self.guesses = start_coefficients(self.profile.size, self.settings)
        self._program: TaskProgram | None = None

    @property
    def program(self) -> TaskProgram:
        """The program with the residual as a variable."""
        if self._program is None or self._program.steps != self.steps:
            self._program = TaskProgram(self.task, self.profile, self.steps)
        return self._program

    def solve(
        self,
        guess: Guess,
        residual_limit: float = np.inf,
        minimise: Mapping[str, float] = LEAST_ENERGY,
        known: Solution | None = None,
    ) -> Solution:
        """Run the solver from one start, and again without its multipliers where that fails.

        Parameters
        ----------
        guess : ndarray, shape (profile.size,), or Solution
            Coefficients, or the solution beside it.
        residual_limit : float
            Largest residual [m].
        minimise : mapping of str to float
            As for `TaskProgram.solve`.
        known : Solution, optional
            As for `TaskProgram.solve`.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        limits = {**self.task.limits, RESIDUAL: residual_limit}
        found = self.program.solve(
            guess, limits, self.settings.bound, minimise, known, reaches=REACHES[:1]
        )
        self.iterations += found.iterations
        if isinstance(guess, Solution) and not found.status.solved:
            return self.solve(guess.coefficients, residual_limit, minimise, known)
        return found

    def ends(self) -> Ends:
        """Find the motion of least energy that arrives at rest, and that whose residual is free.

        The number of steps is raised until the independent integrator agrees with the still end.
        Where no motion arrives at rest, that end is the motion of least residual.

        Returns
        -------
        Ends
            The ends of the front.

        Raises
        ------
        InfeasibleTaskError
            When no motion of this profile keeps the task's limits.
        SolverFailedError
            When no start ended at an optimum for another reason.
        """
        bound, free = self.settings.bound, {**self.task.limits, RESIDUAL: np.inf}
        still = self._at_rest()  # first: it settles the number of steps
        cheapest = least_energy(self.program, self.profile, free, bound, self.guesses)
        self.iterations += cheapest.iterations
        if still is None:
            least = least_peaks(self.program, self.profile, free, bound, self.guesses)
            if RESIDUAL not in least:
                return Ends(
                    cheapest,
                    self.checked(cheapest, {RESIDUAL_LIMIT: cheapest.peaks[RESIDUAL]}),
                    cheapest,
                )
            limit = least[RESIDUAL].peaks[RESIDUAL] * (1 + _SAMPLING)
            found = self.solve(least[RESIDUAL].coefficients, limit)
            found = found if found.status.solved else least[RESIDUAL]
            still = found, self.checked(found, {RESIDUAL_LIMIT: limit})
        return Ends(*still, cheapest)

    def _at_rest(self) -> tuple[Solution, FrontPoint] | None:
        bound, limits = self.settings.bound, {**self.task.limits, RESIDUAL: 0.0}
        try:
            found = least_energy(self.program, self.profile, limits, bound, self.guesses)
            found, motion, self.steps = verified(
                self.program, found, limits, bound, enough_steps=self.steps
            )
            end, motion, _ = verified(self.program, found, limits, bound)
        except SolverFailedError:
            return None
        self.iterations += end.iterations
        return found, self._point(end, motion)

    def _point(self, found: Solution, motion: Motion) -> FrontPoint:
        return FrontPoint(self.profile.checked(found.coefficients), motion.residual, motion.energy)

    def checked(
        self,
        found: Solution,
        asked: Mapping[str, float],
        most_residual: float = np.inf,
        free: bool = False,
    ) -> FrontPoint | FailedPoint:
        """Give a solution the figures of the independent integrator.

        Parameters
        ----------
        found : Solution
            A solution of the program.
        asked : mapping of str to float
            What was asked for.
        most_residual : float
            Largest residual [m] that the point may have; it may be a little off that asked for.
        free : bool
            Whether the residual is free: an end of the front, which more steps may move.

        Returns
        -------
        FrontPoint or FailedPoint
            The point, or why it cannot be trusted.
        """
        limits = {**self.task.limits, RESIDUAL: np.inf if free else found.residual}
        kept = {**self.task.limits, RESIDUAL: most_residual}
        try:
            point, motion, _ = verified(
                self.program, found, limits, self.settings.bound,
                most_steps=MOST_STEPS if free else _MORE_STEPS * self.steps,
                enough_steps=ENOUGH_STEPS if free else _MORE_STEPS * self.steps, kept=kept,
            )  # fmt: skip
        except SolverFailedError as error:
            return FailedPoint(asked, str(error))
        self.iterations += point.iterations - found.iterations  # more steps, or tighter limits
        return self._point(point, motion)

    def all_checked(
        self,
        found: Sequence[tuple[Solution, Mapping[str, float]]],
        *,
        interrupted: bool = False,
        heed: Callable[[], None] = lambda: None,
    ) -> tuple[list[FrontPoint | FailedPoint], bool]:
        """Check many solutions; after Ctrl-C those that there is time for, spread evenly.

        Parameters
        ----------
        found : sequence of (Solution, mapping of str to float)
            As for `checked`.
        interrupted : bool
            Whether Ctrl-C came before.
        heed : callable, optional
            Called before each; raises KeyboardInterrupt once it is to stop.

        Returns
        -------
        list of FrontPoint or FailedPoint
            In the order given.
        bool
            Whether these are all.
        """
        checked, until = dict[int, FrontPoint | FailedPoint](), np.inf
        with note_interrupts() as came:
            evenly = sorted(range(len(found)), key=lambda i: f"{i:032b}"[::-1])  # ever finer
            for i in evenly:
                try:
                    heed()
                except KeyboardInterrupt:
                    interrupted = True
                if interrupted or came:
                    until = min(until, time.monotonic() + _PATIENCE)
                if time.monotonic() > until:
                    break
                checked[i] = self.checked(*found[i])
        return [checked[i] for i in sorted(checked)], len(checked) == len(found)

    def front(
        self,
        method: str,
        found: Sequence[FrontPoint | FailedPoint],
        points: int,
        *,
        gaps: Sequence[tuple[float, float]] = (),
        iterations: int = 0,
        complete: bool = True,
        seconds: float = 0.0,
    ) -> Front:
        """Put points together to a front.

        Parameters
        ----------
        method : str
            How they were found.
        found : sequence of FrontPoint or FailedPoint
            The points.
        points : int
            How many were asked for.
        gaps : sequence of (float, float)
            As in `Front`.
        iterations : int
            Iterations of the solver in other processes.
        complete : bool
            Whether the sweep ran to its end.
        seconds : float
            Time that was spent before the sweep [s].

        Returns
        -------
        Front
            The front.
        """
        failures = tuple(point for point in found if isinstance(point, FailedPoint))
        settings = self.settings
        return Front(
            task=self.task,
            profile=self.profile,
            points=non_dominated(point for point in found if isinstance(point, FrontPoint)),
            method=method,
            settings={"bound": settings.bound, "points": points, "starts": settings.starts,
                      "steps": self.steps},
            seed=settings.seed,
            reference=reference_corner(self.task),
            iterations=self.iterations + iterations,
            failed=len(failures),
            failures=failures,
            gaps=tuple(gaps),
            complete=complete,
            seconds=seconds + time.perf_counter() - self.began,
        )  # fmt: skip
