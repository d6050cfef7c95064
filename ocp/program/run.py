"""Runs of IPOPT on a task's program with limits, a box and weights, all scaled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from models import Plant
from ocp.base.status import SolveStatus
from ocp.profiles.joint_profile import JointProfile
from ocp.program.condensed import Condensed, condensed
from ocp.program.ipopt import CREEPING, PEAK, RESOLVED, SAMPLED, UNBOXED, Point, Stop
from ocp.program.solution import ENERGY, Solution
from ocp.program.task_program import TaskProgram
from ocp.program.transcription import RESIDUAL, Form, NonlinearProgram
from ocp.robustness.uncertain import UncertainPlant
from ocp.simulation.collocation import NODES
from ocp.simulation.objective import two_samples

_SLACK_ROOM = 1e-2
"""The unknowns of |power| start this far from their bound 0, as a share of the peak power."""
_FIRST_REACH = 0.25
"""How far the unknowns along even axes may move from a cold start at first: minima of the paper's
conditions lie within 0.2 of the cycloid."""
_REACH = 0.1
"""How far they may move from a neighbouring minimum, relative to 1 or to their own size."""
_KEPT, _NEARLY_KEPT = 1e-7, 1e-6
"""A motion that passes a scaled constraint by no more keeps it, or will after corrections."""


@lru_cache(maxsize=64)
def _compiled(
    plant: Plant,
    profile: JointProfile,
    steps: int,
    quantities: tuple[str, ...],
    form: Form,
    boxed: bool,
) -> NonlinearProgram:
    motion = condensed(plant, profile, steps, quantities)
    sampled = CREEPING if _creeps(motion) else SAMPLED if boxed else UNBOXED
    options = {"sampled": sampled, "resolved": RESOLVED, "free": PEAK}[form.energy]
    return NonlinearProgram(motion, form, options)


def _creeps(motion: Condensed) -> bool:
    """Whether it is one of several plants whose coefficients enter nonlinearly; see `CREEPING`."""
    return isinstance(motion.plant, UncertainPlant) and motion.basis_size == 0


@dataclass(frozen=True)
class Run:
    """What is asked of a program in one call, scaled.

    Attributes
    ----------
    program : TaskProgram
        The task's numbers.
    form : Form
        The program to begin with: sampled where the energy counts.
    limits, weights : mapping of str to float
        Largest residual and peaks; weights of energy and at most one peak, the largest of them 1.
    box : tuple of ndarray, each of shape (coefficients,)
        Least and largest coefficients.
    offset : ndarray, shape (2 * modes,)
        What the steps miss of the state on arrival.
    axes : ndarray, shape (coefficients, coefficients)
        The coefficients are these times the unknowns.
    """

    program: TaskProgram
    form: Form
    limits: Mapping[str, float]
    weights: Mapping[str, float]
    box: tuple[NDArray[np.float64], NDArray[np.float64]]
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
    ) -> Run:
        """Scale what is asked; arguments as for `Problem`."""
        least = next((name for name in minimise if name != ENERGY), None)
        still = limits.get(RESIDUAL, np.inf) == 0 and least != RESIDUAL
        weights = {name: weight * program.reference[name] for name, weight in minimise.items()}
        largest = max(weights.values())
        box = program.profile.box(bound)
        return cls(
            program=program,
            form=Form(
                "sampled" if ENERGY in minimise else "free",
                0 if still else len(program.matrix),
                least,
            ),
            limits={name: limit / program.reference[name] for name, limit in limits.items()},
            weights={name: weight / largest for name, weight in weights.items()},
            box=box,
            offset=np.zeros(program.motion.states) if offset is None else offset,
            # a box is one along the coefficients themselves
            axes=np.eye(program.motion.size) if np.isfinite(box).any() else program.even_axes,
        )

    @property
    def resolved(self) -> Form:
        """The same program with the energy resolved."""
        return self.form._replace(energy="resolved")

    def cold(self, guess: NDArray[np.float64]) -> Solution:
        """Solve from coefficients alone, at first not too far from them where nothing bounds them.

        IPOPT's first steps are the longest, and far from the cycloid it loses its way.
        """
        start = self.start(guess, self.form)
        if np.isfinite(self.box).any():
            return self.solution(self.form, self.stop(self.form, start))
        stop = self.stop(self.form, start, _FIRST_REACH)
        iterations = stop.iterations
        moved = np.abs(stop.point.unknowns - start.unknowns)[: self.program.motion.size].max()
        status = SolveStatus.from_ipopt(stop.return_status)
        ended = status.solved or status is SolveStatus.INFEASIBLE
        if not ended or moved > 0.99 * _FIRST_REACH:
            stop = self.stop(self.form, start)
            iterations += stop.iterations
        return replace(self.solution(self.form, stop), iterations=iterations)

    def finished(self, found: Solution) -> Solution:
        """Go on from a sampled minimum to that of the resolved energy.

        The result must keep the constraints and be better; else the given solution is kept. One
        found with another number of steps, whose energy cannot be compared, is kept only if this
        run fails.
        """
        start = self.start(found.coefficients, self.resolved)
        power = len(found.point.unknowns) - len(start.unknowns)  # two for each sample
        start = Point(
            start.unknowns, found.point.bound_multipliers[:-power],
            found.point.multipliers[power // 2 :],
        )  # fmt: skip
        after = self.beside(replace(found, form=self.resolved, point=start))
        comparable = power == 4 * self.program.steps
        better = not comparable or self._value(after) <= self._value(found)
        better = better and after.status.solved
        return replace(after if better else found, iterations=after.iterations)

    def beside(self, found: Solution) -> Solution:
        """Go on from a solution of the resolved program to the minimum beside it.

        Where that is not reached but every constraint is kept, the status does not change.
        """
        stop = self.stop(self.resolved, found.point, _REACH)
        after = self.solution(self.resolved, stop)
        settled = after.status.solved
        return replace(
            after,
            status=found.status if settled or stop.passed <= _KEPT else after.status,
            iterations=found.iterations + stop.iterations,
            settled=settled,
        )

    def start(self, guess: NDArray[np.float64], form: Form) -> Point:
        """Unknowns that agree with the guess: its own peak, arrival and power."""
        states, outputs, _ = self.program.figures(guess)
        arrival = states[:, -1] + self.offset
        peak = [] if form.least is None else [self.program.peaks(arrival, outputs)[form.least]]
        power = np.empty(0)
        if form.sampled:
            at_nodes = self.program.by_group(outputs)["power"].reshape(-1, NODES).T
            sampled = (two_samples() @ at_nodes).ravel(order="F")
            power = np.append(np.maximum(sampled, 0), np.maximum(-sampled, 0)) + _SLACK_ROOM
        along = np.linalg.solve(self.axes, guess)
        return Point(np.concatenate([along, peak, arrival if form.residual_rows else [], power]))

    def stop(self, form: Form, start: Point, reach: float = np.inf) -> Stop:
        """Run one form of the program, no farther than `reach` from the start."""
        program, task = self.program, self.program.task
        compiled = _compiled(
            task.plant, program.profile, program.steps, tuple(task.limits), form,
            boxed=form.sampled and bool(np.isfinite(self.box).all()),
        )  # fmt: skip
        lower, upper = (np.full(compiled.unknowns, sign * np.inf) for sign in (-1, 1))
        place = compiled.part("coefficients")
        lower[place], upper[place] = self.box
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
        coefficients = np.clip(coefficients, *self.box)  # IPOPT passes by 1e-10
        states, outputs, energy = program.figures(coefficients)
        arrival = states[:, -1] + self.offset
        peaks, reference = self.program.peaks(arrival, outputs), program.reference
        slope = 0.0
        if form.residual_rows and form.least is None:
            slope = -float(np.abs(stop.point.multipliers[-form.residual_rows :]).sum())
        return Solution(
            coefficients=coefficients,
            energy=energy * reference[ENERGY],
            peaks={name: peak * reference[name] for name, peak in peaks.items()},
            status=self._status(form, stop),
            slope=slope * reference[ENERGY] / reference[RESIDUAL],
            iterations=stop.iterations,
            arrival=arrival * program.scale[: program.motion.states],
            form=form,
            point=stop.point,
        )

    def _status(self, form: Form, stop: Stop) -> SolveStatus:
        """How the solver stopped; where it creeps, a motion that keeps the limits is acceptable."""
        status = SolveStatus.from_ipopt(stop.return_status)
        crept = form.sampled and _creeps(self.program.motion) and stop.passed <= _NEARLY_KEPT
        if status is SolveStatus.ITERATION_LIMIT and crept:
            return SolveStatus.ACCEPTABLE
        return status

    def _value(self, found: Solution) -> float:
        values = {ENERGY: found.energy, **found.peaks}
        return sum(
            w * values[name] / self.program.reference[name] for name, w in self.weights.items()
        )
