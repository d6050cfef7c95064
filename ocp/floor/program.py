"""The nonlinear program over all joint motions, with one task's numbers in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.ocp.base.interrupts import keep_interrupts
from quietarm.ocp.base.status import SolveStatus
from quietarm.ocp.floor.grid import first_grid
from quietarm.ocp.floor.step_model import by_group
from quietarm.ocp.floor.transcription import FreePoint, FreeProgram
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.joint_profile import JointPath
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.program.ipopt import OPTIONS
from quietarm.ocp.program.solution import ENERGY
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES
from quietarm.ocp.task.point_to_point import PointToPoint
from quietarm.ocp.task.quantities import ask_for_jerk

_COLD = {**OPTIONS, "tol": 1e-8, "max_iter": 400, "mumps_pivot_order": 0}
"""The systems are sparse and have no dense columns: minimum degree makes them a quarter faster."""
_WARM = {**_COLD, "mu_strategy": "monotone", "mu_init": 1e-6, "max_iter": 150}
"""From a coarser grid's solution; with a larger barrier the solver would move away from it."""
_SCALE_STEPS = 40
_SLACK_ROOM = 1e-2
"""How far the slacks of |power| start inside their constraints, as a share of the peak power."""


@lru_cache(maxsize=16)
def _compiled(
    plant: Plant, smooth: bool, steps: int, quantities: tuple[str, ...], warm: bool
) -> FreeProgram:
    return FreeProgram(plant, smooth, steps, quantities, _WARM if warm else _COLD)


@dataclass(frozen=True)
class FreeSolution:
    """What one run of the solver gives, in SI units and by its own discretisation."""

    free: FreeMotion
    energy: float
    peaks: dict[str, float]
    status: SolveStatus
    iterations: int


class FloorProgram:
    """A task on a grid."""

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(self, task: PointToPoint, smooth: bool) -> None:
        if ask_for_jerk(task.limits) and not smooth:
            raise ValueError(
                f"jerk limit is {task.jerk_limit:g} rad/s^3 and the acceleration of this floor "
                "jumps; ask for a smooth floor (smooth=True, or --smooth)"
            )
        self.task, self.smooth = task, smooth
        self._scale = self._measures()

    def along(self, path: JointPath, fractions: NDArray[np.float64]) -> FreeMotion:
        """A motion of this kind on a grid whose speed at the grid is that of a path."""
        times = self.task.duration * fractions
        h = np.diff(times)
        if self.smooth:
            acceleration = path(times, 2)
            acceleration[[0, -1]] = 0.0
            return FreeMotion(times, acceleration[:-1], np.diff(acceleration) / h)
        return FreeMotion(times, np.diff(path(times, 1)) / h, np.zeros(len(h)))

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def solve(
        self,
        free: FreeMotion,
        limits: Mapping[str, float],
        minimise: str = ENERGY,
        warm: bool = False,
    ) -> FreeSolution:
        """Run the solver from one motion, on its grid."""
        program = self._program(free.steps, warm)
        weights = [float(name == minimise) for name in (ENERGY, *program.peaks)]
        parameters = np.concatenate([free.lengths, self._scale, weights])
        point, stop = program.solve(
            self._start(program, free), *self._bounds(program, limits), parameters
        )
        reference = self._reference(program)
        nodes = np.outer(free.lengths, GAUSS_WEIGHTS).ravel()
        rows = point.intervals * self._scale[: program.model.unknowns, None]
        derivative = rows[program.model.joint - 1, :-1]
        return FreeSolution(
            free=FreeMotion(
                free.times,
                rows[2, :-1] if self.smooth else derivative,
                derivative if self.smooth else np.zeros(free.steps),
            ),
            energy=float(nodes @ point.slack * reference["power"]),
            peaks={
                name: float(peak * reference[name])
                for name, peak in zip(program.peaks, point.peaks, strict=True)
            },
            status=SolveStatus.from_ipopt(stop.return_status),
            iterations=stop.iterations,
        )

    def _program(self, steps: int, warm: bool) -> FreeProgram:
        task = self.task
        return _compiled(task.plant, self.smooth, steps, tuple(task.limits), warm)

    def _measures(self) -> NDArray[np.float64]:
        """What the plain cycloid reaches, so that the solver sees numbers of order one."""
        path = CycloidPolynomial(0).path([], *self.task.move)
        free = self.along(path, first_grid(_SCALE_STEPS))
        program = self._program(free.steps, warm=False)
        model = program.model
        unknowns, outputs = self._simulate(program, free, np.ones(model.scales))
        peaks = [np.abs(rows).max() for rows in by_group(model.groups, outputs).values()]
        measures = np.array([*np.abs(unknowns).max(axis=1), *peaks])
        measures[0] = abs(self.task.span)
        measures[measures == 0] = 1.0
        return measures

    def _reference(self, program: FreeProgram) -> dict[str, float]:
        """Scale of each output and of each limited derivative of the joint, by name."""
        of_joint = {name: self._scale[row] for name, row in program.of_joint.items()}
        outputs = self._scale[program.model.unknowns :]
        return of_joint | dict(zip(program.model.outputs, outputs, strict=True))

    def _simulate(
        self, program: FreeProgram, free: FreeMotion, scale: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        model = program.model
        inputs = free.jerk if self.smooth else free.acceleration
        initial = self._at_rest(program, self.task.start) / scale[: model.unknowns]
        return program.simulate(
            initial[model.after], inputs / scale[model.joint - 1], free.lengths, scale
        )

    @staticmethod
    def _at_rest(program: FreeProgram, angle: float) -> NDArray[np.float64]:
        return np.append(angle, np.zeros(program.model.unknowns - 1))

    def _start(self, program: FreeProgram, free: FreeMotion) -> FreePoint:
        """Unknowns that agree with the motion: its own modes, slacks and peaks."""
        unknowns, outputs = self._simulate(program, free, self._scale)
        values = by_group(program.model.groups, outputs)
        values |= {name: unknowns[row] for name, row in program.of_joint.items()}
        return FreePoint(
            peaks=np.array([np.abs(values[name]).max() for name in program.peaks]),
            intervals=unknowns,
            slack=np.abs(values["power"].ravel(order="F")) + _SLACK_ROOM,
        )

    def _bounds(
        self, program: FreeProgram, limits: Mapping[str, float]
    ) -> tuple[FreePoint, FreePoint]:
        model, reference = program.model, self._reference(program)
        free, slack = (
            np.full((model.unknowns, program.steps + 1), np.inf),
            np.full(NODES * program.steps, np.inf),
        )
        peaks = np.array([limits.get(name, np.inf) / reference[name] for name in program.peaks])
        lower, upper = -free, free
        scale = self._scale[: model.unknowns]
        arrived = self._at_rest(program, self.task.target) / scale
        initial = self._at_rest(program, self.task.start) / scale
        lower[model.after, 0] = upper[model.after, 0] = initial[model.after]
        lower[:, -1] = upper[:, -1] = arrived
        return (
            FreePoint(np.zeros(len(peaks)), lower, -slack),
            FreePoint(peaks, upper, slack),
        )
