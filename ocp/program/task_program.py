"""A nonlinear program for one task: scales, bounds and start values around the compiled one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Plant
from ocp.base.interrupts import keep_interrupts
from ocp.base.status import SolveStatus
from ocp.profiles.joint_profile import JointProfile
from ocp.program.condensed import condensed
from ocp.program.ipopt import BESIDE, FINISH, RESOLVED, SAMPLED
from ocp.program.solution import ENERGY, LEAST_ENERGY, Solution, same_minimum
from ocp.program.transcription import RESIDUAL, Form, NonlinearProgram, Point, Stop
from ocp.simulation.collocation import NODES
from ocp.simulation.objective import two_samples
from ocp.simulation.residual import residual_rows
from ocp.task.point_to_point import PointToPoint

_ROWS_AT_ONCE = 32
"""Residual rows are filled up to a multiple of this: tasks that differ by a row share a program."""
_SLACK_ROOM = 1e-2
"""How far the parts of the power start from zero, as a share of the peak power."""
REACHES = (0.1, 0.003)
"""How far coefficients may move from the sampled minimum, against 1 or their own size; where zeros
of the power meet the solver loses its way beyond the second."""
_KEPT = 1e-7
"""A motion that passes a scaled constraint by no more than this keeps it."""


@lru_cache(maxsize=32)
def _compiled(
    plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...], form: Form
) -> NonlinearProgram:
    motion = condensed(plant, profile, steps, quantities)
    if form.sampled:
        return NonlinearProgram(motion, form, SAMPLED, BESIDE)
    return NonlinearProgram(motion, form, RESOLVED, FINISH)


class TaskProgram:
    """The compiled program with one task's numbers in it.

    Everything is measured against the profile with all coefficients zero, so that the solver sees
    numbers of order one for any plant.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    steps : int
        Number of steps.

    Attributes
    ----------
    of_cycloid : float
        Residual of the plain cycloid [m].
    """

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(self, task: PointToPoint, profile: JointProfile, steps: int) -> None:
        self.task, self.profile, self.steps = task, profile, steps
        self.motion = motion = condensed(task.plant, profile, steps, tuple(task.limits))
        self.even_axes = motion.even_axes(task.move)
        self.scale = np.ones(motion.scales)
        states, outputs, _ = self.figures(np.zeros(profile.size))
        peaks = [np.abs(rows).max() for rows in self.by_group(outputs).values()]
        self.scale = np.array([*np.abs(states).max(axis=1), *peaks])
        self.scale[self.scale == 0] = 1.0
        names = [group.name for group in motion.groups[1:]]
        self.reference = dict(zip(names, self.scale[motion.states :].tolist(), strict=True))
        self.reference[ENERGY] = self.reference["power"] * task.duration
        matrix = _filled_up(residual_rows(task)) * self.scale[: motion.states]
        self.of_cycloid = float(
            np.abs(matrix @ (states[:, -1] / self.scale[: motion.states])).max()
        )
        self.reference[RESIDUAL] = float(np.abs(matrix).max())
        self.matrix = matrix / self.reference[RESIDUAL]

    @keep_interrupts()
    def solve(
        self,
        guess: NDArray[np.float64] | Solution,
        limits: Mapping[str, float],
        bound: float | None,
        minimise: Mapping[str, float] = LEAST_ENERGY,
        known: Solution | None = None,
        reaches: Sequence[float] = REACHES,
    ) -> Solution:
        """Run the solver from one vector of coefficients, or on from another solution.

        Parameters
        ----------
        guess : ndarray, shape (profile.size,), or Solution
            Coefficients to start from, or a solution of this task with limits or weights that are
            a little different.
        limits : mapping of str to float
            Largest residual [m], 0 for rest on arrival, and peaks [SI units]; a quantity without
            an entry is free.
        bound : float or None
            Largest absolute coefficient.
        minimise : mapping of str to float
            Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is made least.
        known : Solution, optional
            What another start led to: it is returned where this start leads there, too.
        reaches : sequence of float
            How far the coefficients may move on from the sampled minimum, one try after another
            until the minimum of the resolved energy is reached; none leaves them there.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        run = _Run.of(self, limits, bound, minimise)
        if isinstance(guess, Solution) and guess.form == run.form:
            start = guess.point
        else:
            start = run.start(guess.coefficients if isinstance(guess, Solution) else guess)
        found = run.solution(run.form, run.stop(run.form, start))
        if not (run.form.sampled and found.status.solved):
            return found
        if known is not None and same_minimum(found, known):
            return replace(known, iterations=found.iterations)
        return run.finished(found, reaches)

    @keep_interrupts()
    def finished(
        self, found: Solution, limits: Mapping[str, float], bound: float | None
    ) -> Solution:
        """Go on from a sampled minimum of the energy to the resolved one; arguments as before."""
        return _Run.of(self, limits, bound, LEAST_ENERGY).finished(found, REACHES)

    @keep_interrupts()
    def corrected(
        self,
        found: Solution,
        arrival: NDArray[np.float64],
        limits: Mapping[str, float],
        bound: float | None,
    ) -> Solution:
        """Solve on from a solution of least energy, with what is known of its true arrival.

        Parameters
        ----------
        found : Solution
            The solution.
        arrival : ndarray, shape (2 * modes,)
            Its state on arrival by an exact integrator: the difference is kept while solving.
        limits : mapping of str to float
            As for `solve`; they may be tighter.
        bound : float or None
            Largest absolute coefficient.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        states, _, _ = self.figures(found.coefficients)
        offset = arrival / self.scale[: self.motion.states] - states[:, -1]
        return _Run.of(self, limits, bound, LEAST_ENERGY, offset).corrected(found)

    def figures(
        self, coefficients: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Scaled states after every step, outputs of every step, energy."""
        inputs = (coefficients, self.task.move, self.scale)
        values = self.motion.figures(*(ca.DM(value) for value in inputs))
        states, outputs, energy = (value.full() for value in values)
        return states, outputs, energy.item()

    def by_group(self, outputs: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Outputs by the quantity's name."""
        first = self.motion.states
        return {
            group.name: outputs[group.first - first : group.first - first + group.rows]
            for group in self.motion.groups[1:]
        }


@dataclass(frozen=True)
class _Run:
    """What is asked of a program in one call, scaled."""

    program: TaskProgram
    form: Form
    limits: Mapping[str, float]
    bound: float
    weights: Mapping[str, float]
    offset: NDArray[np.float64]
    axes: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        program: TaskProgram,
        limits: Mapping[str, float],
        bound: float | None,
        minimise: Mapping[str, float],
        offset: NDArray[np.float64] | None = None,
    ) -> _Run:
        least = next((name for name in minimise if name != ENERGY), None)
        still = limits.get(RESIDUAL, np.inf) == 0 and least != RESIDUAL
        weights = {name: weight * program.reference[name] for name, weight in minimise.items()}
        largest = max(weights.values())
        return cls(
            program=program,
            form=Form(ENERGY in minimise, 0 if still else len(program.matrix), least),
            limits={name: limit / program.reference[name] for name, limit in limits.items()},
            bound=np.inf if bound is None else bound,
            weights={name: weight / largest for name, weight in weights.items()},
            offset=np.zeros(program.motion.states) if offset is None else offset,
            # a box is one along the coefficients themselves
            axes=program.even_axes if bound is None else np.eye(program.motion.size),
        )

    def start(self, guess: NDArray[np.float64]) -> Point:
        """Unknowns that agree with the guess: its own peak, arrival and power."""
        states, outputs, energy = self.program.figures(guess)
        arrival, form = states[:, -1] + self.offset, self.form
        peak = [] if form.least is None else [self._peaks(arrival, outputs)[form.least]]
        power = np.array([energy])
        if form.sampled:
            at_nodes = self.program.by_group(outputs)["power"].reshape(-1, NODES).T
            sampled = (two_samples() @ at_nodes).ravel(order="F")
            power = np.append(np.maximum(sampled, 0), np.maximum(-sampled, 0)) + _SLACK_ROOM
        along = np.linalg.solve(self.axes, guess)
        return Point(np.concatenate([along, peak, arrival if form.residual_rows else [], power]))

    def stop(self, form: Form, start: Point, reach: float = np.inf) -> Stop:
        """Run one form of the program, no farther than `reach` from the start."""
        program, task = self.program, self.program.task
        compiled = _compiled(task.plant, program.profile, program.steps, tuple(task.limits), form)
        upper = np.full(compiled.unknowns, np.inf)
        upper[compiled.part("coefficients")] = self.bound
        lower = -upper
        place = compiled.part("coefficients")
        room = reach * np.maximum(1.0, np.abs(start.unknowns[place]))
        lower[place] = np.maximum(lower[place], start.unknowns[place] - room)
        upper[place] = np.minimum(upper[place], start.unknowns[place] + room)
        if form.sampled:
            lower[compiled.part("power")] = 0.0
        both = [self.weights.get(ENERGY, 0.0), self.weights.get(form.least or "", 0.0)]
        matrix = program.matrix[: form.residual_rows].ravel(order="F")
        basis = program.motion.basis(task.move, self.axes)
        parameters = [task.move, program.scale, both, self.offset, matrix, basis]
        return compiled.solve(start, (lower, upper), self.limits, np.concatenate(parameters))

    def solution(self, form: Form, stop: Stop) -> Solution:
        """The figures of where the solver stopped."""
        program = self.program
        coefficients = self.axes @ stop.point.unknowns[: program.motion.size]
        coefficients = np.clip(coefficients, -self.bound, self.bound)  # IPOPT passes by 1e-10
        states, outputs, energy = program.figures(coefficients)
        arrival = states[:, -1] + self.offset
        peaks, reference = self._peaks(arrival, outputs), program.reference
        slope = 0.0
        if form.residual_rows and form.least is None:
            slope = -float(np.abs(stop.point.multipliers[-form.residual_rows :]).sum())
        return Solution(
            coefficients=coefficients,
            energy=energy * reference[ENERGY],
            peaks={name: peak * reference[name] for name, peak in peaks.items()},
            status=SolveStatus.from_ipopt(stop.return_status),
            slope=slope * reference[ENERGY] / reference[RESIDUAL],
            iterations=stop.iterations,
            arrival=arrival * program.scale[: program.motion.states],
            form=form,
            point=stop.point,
        )

    def finished(self, found: Solution, reaches: Sequence[float]) -> Solution:
        """Go on from the sampled minimum to that of the resolved energy.

        What is found must keep the constraints and be better, else the given solution stands.
        Status and point stay those of the sampled program, from which a neighbouring solve starts.
        """
        best = found
        for reach in reaches:
            stop = self.stop(self.resolved, best.finish or self._resolved_start(found), reach)
            best = replace(best, iterations=best.iterations + stop.iterations)
            after = self._after(best, stop)
            if after is not None and self._value(after) <= self._value(best):
                best = after
            if best.settled:
                break
        return best

    def corrected(self, found: Solution) -> Solution:
        """Solve on from a solution for what is asked now, by the program that it is of."""
        if found.form != self.form:  # of a weighted sum: its unknowns are others
            again = self.solution(self.form, self.stop(self.form, self.start(found.coefficients)))
            again = self.finished(again, REACHES) if again.status.solved else again
            return replace(again, iterations=found.iterations + again.iterations)
        if found.finish is not None:
            stop = self.stop(self.resolved, found.finish, REACHES[0])
            after = self._after(replace(found, iterations=found.iterations + stop.iterations), stop)
            if after is not None:
                return after
        again = self.solution(self.form, self.stop(self.form, found.point))
        return replace(again, iterations=found.iterations + again.iterations)

    @property
    def resolved(self) -> Form:
        """The same program with the energy resolved."""
        return self.form._replace(sampled=False)

    def _after(self, found: Solution, stop: Stop) -> Solution | None:
        """The solution where the resolved program stopped, None where a constraint is passed."""
        after = self.solution(self.resolved, stop)
        if not after.status.solved and stop.passed > _KEPT:
            return None
        return replace(
            after,
            status=found.status,
            iterations=found.iterations,
            form=found.form,
            point=found.point,
            finish=stop.point,
            settled=after.status.solved,
        )

    def _resolved_start(self, found: Solution) -> Point:
        """The same point with one energy in the place of the power at the nodes."""
        point, power = found.point, 4 * self.program.steps
        return Point(
            np.append(point.unknowns[:-power], found.energy / self.program.reference[ENERGY]),
            np.append(point.bound_multipliers[:-power], 0.0),
            np.append(self.weights[ENERGY], point.multipliers[power // 2 :]),
        )

    def _peaks(
        self, arrival: NDArray[np.float64], outputs: NDArray[np.float64]
    ) -> dict[str, float]:
        values = {RESIDUAL: self.program.matrix @ arrival, **self.program.by_group(outputs)}
        return {
            name: float(np.abs(value).max()) for name, value in values.items() if name != "power"
        }

    def _value(self, found: Solution) -> float:
        values = {ENERGY: found.energy, **found.peaks}
        return sum(
            w * values[name] / self.program.reference[name] for name, w in self.weights.items()
        )


def _filled_up(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pad(rows, ((0, -len(rows) % _ROWS_AT_ONCE), (0, 0)), mode="edge")
