"""A problem to solve: a task's program with limits, a box and starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ocp.base.interrupts import keep_interrupts
from ocp.program.run import Run
from ocp.program.solution import LEAST_ENERGY, Solution
from ocp.program.task_program import TaskProgram
from ocp.simulation.piecewise import PiecewiseMotion
from ocp.simulation.resimulation import Resimulation, resimulated

_LEAST_COLD_STEPS, _COLD_STEPS_A_TERM = 24, 6
"""Least steps of cold runs, in all and for each term: with fewer, some end at other minima."""


@dataclass(frozen=True)
class Problem:
    """A task's program with limits, a box and starts.

    Attributes
    ----------
    program : TaskProgram
        The task's numbers.
    limits : mapping of str to float
        Largest residual [m], 0 for rest on arrival, and peaks [SI units]; a quantity without an
        entry is free.
    bound : float or None
        Largest absolute coefficient.
    guesses : sequence of ndarray, shape (profile.size,)
        Coefficients to start from.
    """

    program: TaskProgram
    limits: Mapping[str, float]
    bound: float | None = None
    guesses: Sequence[NDArray[np.float64]] = ()

    def within(self, limits: Mapping[str, float]) -> Problem:
        """The same with other limits."""
        return replace(self, limits=limits)

    def finer(self) -> Problem:
        """The same with twice the steps."""
        program = self.program
        return replace(self, program=TaskProgram(program.task, program.profile, 2 * program.steps))

    @cached_property
    def coarse(self) -> TaskProgram:
        """The program that cold runs begin with.

        Half the steps lead to the sampled minimum as well, unless limits hold at the nodes or a
        second mode bends the power more.
        """
        task, profile, steps = self.program.task, self.program.profile, self.program.steps
        coarse = max(_LEAST_COLD_STEPS, steps // 2, _COLD_STEPS_A_TERM * (profile.size - 2))
        if task.limits or task.plant.modes > 1 or coarse >= steps:
            return self.program
        return TaskProgram(task, profile, coarse)

    def _run(self, minimise: Mapping[str, float], program: TaskProgram | None = None) -> Run:
        return Run.of(program or self.program, self.limits, self.bound, minimise)

    @keep_interrupts()
    def solve(
        self,
        guess: NDArray[np.float64] | Solution,
        minimise: Mapping[str, float] = LEAST_ENERGY,
        *,
        finish: bool = True,
    ) -> Solution:
        """Run the solver from coefficients, or from an earlier solution.

        Parameters
        ----------
        guess : ndarray, shape (profile.size,), or Solution
            Coefficients to start from, or a solution of this program with limits or weights that
            are a little different: where no minimum is beside it, its coefficients.
        minimise : mapping of str to float
            Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is made least.
        finish : bool
            Whether to go on from the sampled minimum to that of the resolved energy.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        run, iterations = self._run(minimise), 0
        if isinstance(guess, Solution):
            if guess.form == run.resolved:
                beside = run.beside(replace(guess, iterations=0))
                if beside.settled:
                    return beside
                iterations = beside.iterations
            guess = guess.coefficients
        found = self._run(minimise, self.coarse).cold(guess)
        if finish and found.form.sampled and found.status.solved:
            found = run.finished(found)
        return replace(found, iterations=iterations + found.iterations)

    def least(self, guess: NDArray[np.float64], limits: Mapping[str, float], name: str) -> Solution:
        """Make one peak as small as it can be within other limits."""
        return self.within(limits).solve(guess, {name: 1.0})

    def resimulated(self, found: Solution) -> Resimulation:
        """A solution's motion by CVODES; SolverFailedError where that cannot follow it."""
        task, profile = self.program.task, self.program.profile
        return resimulated(task, PiecewiseMotion.of_profile(task, profile, found.coefficients))

    @keep_interrupts()
    def finished(self, found: Solution) -> Solution:
        """Go on from a sampled minimum of the energy to the resolved one."""
        return self._run(LEAST_ENERGY).finished(found)

    @keep_interrupts()
    def corrected(self, found: Solution, arrival: NDArray[np.float64]) -> Solution:
        """Go on from a solution of least energy, corrected by its true state on arrival.

        Parameters
        ----------
        found : Solution
            A solution of this program; the limits may be tighter.
        arrival : ndarray, shape (2 * modes,)
            Its state on arrival by an exact integrator: the difference is kept while solving.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        states, _, _ = self.program.figures(found.coefficients)
        offset = arrival / self.program.scale[: self.program.motion.states] - states[:, -1]
        run = Run.of(self.program, self.limits, self.bound, LEAST_ENERGY, offset)
        after = run.beside(found) if found.form == run.resolved else None
        if after is not None and after.status.solved:
            return after
        again = run.cold(found.coefficients)
        if again.status.solved:
            again = run.finished(again)
        return replace(again, iterations=(after or found).iterations + again.iterations)

    @keep_interrupts()
    def refined(self, found: Solution) -> Solution:
        """Go on from a solution of least energy that was found with another number of steps."""
        run = self._run(LEAST_ENERGY)
        if found.form == run.resolved and not self.program.task.limits:
            # limits hold at the nodes, whose multipliers are others then
            unknowns = run.start(found.coefficients, run.resolved).unknowns
            after = run.beside(replace(found, point=replace(found.point, unknowns=unknowns)))
            if after.status.solved:
                return after
        return self.solve(found.coefficients)
