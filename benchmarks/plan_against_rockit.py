"""Plan time against the same problem in rockit-meco, at the same discretisation and tolerance.

    pip install ".[benchmark]"
    python benchmarks/plan_against_rockit.py [--repetitions 5] [--steps 100] [--same-start]

Two moves with six terms, at rest on arrival, coefficients in the paper's box: the arm on a flexible
link (0 to pi/2 in 0.8 s) and the single-link manipulator (0 to pi/6 in 0.8 s). Both sides

- take the equations from the same lines: the plant's own methods and the profile's `motion`;
- take the same steps of three Gauss nodes on the same graded mesh (rockit: `DirectCollocation` of
  degree 3, scheme "legendre", on a `FunctionGrid`). quietarm eliminates the nodes' unknowns from
  each step, rockit leaves them to the solver: the solutions are the same;
- make |power| exact by a slack at every node (rockit: an algebraic variable s with s >= p, s >= -p
  on the grid "integrator_roots"), and minimise the same quadrature of it (rockit: `ocp.integral`);
- measure states and power in the same units, and run the same IPOPT with the same options;
- start from the plain cycloid, all coefficients zero, and from nowhere else.

rockit starts the modes and slacks at zero, its default, where quietarm starts them at those of the
plain cycloid. `--same-start` gives these to rockit, too, which takes it longer. rockit runs with
`expand`, as in its own examples: without it, it takes several times as long.

Times are the processor's, not the wall clock's: everything here runs on one thread, where the two
are the same on an idle machine, and other work on a shared one disturbs the processor's less.

Printed are medians over interleaved repetitions, and the median of the ratios within a repetition:

- build and solve: everything from the task to the coefficients, nothing built before. quietarm's
  time is `plan_move`'s and includes the verification by CVODES, which rockit's has no like of;
- second call: the same again with all built, `plan_move` against `ocp.solve`;
- solver alone: as the second call, without the verification;
- energies by each side's own discretisation, which must agree.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from statistics import median
from time import process_time

import casadi as ca
import numpy as np
import rockit
from common import console, forget_compiled, load_plugins, machine, timed
from rich.table import Table
from rockit.sampling_method import FunctionGrid

from models import ArmOnFlexibleLink, SingleLinkManipulator
from ocp import CycloidPolynomial, Plan, PointToPoint, plan_move
from ocp.collocation import GAUSS_NODES, NODES, mesh
from ocp.program import OPTIONS, SLACK_ROOM, TaskProgram

PROFILE = CycloidPolynomial(6)
AT_REST = {"residual": 0.0}


@dataclass(frozen=True)
class Move:
    """A move with the box on its coefficients."""

    title: str
    task: PointToPoint
    bound: float


MOVES = [
    Move(
        "arm on flexible link, 0 to pi/2 in 0.8 s, |a_n| <= 0.5",
        PointToPoint(ArmOnFlexibleLink(), target=pi / 2, duration=0.8),
        0.5,
    ),
    Move(
        "single link, 0 to pi/6 in 0.8 s, |a_n| <= 0.2",
        PointToPoint(SingleLinkManipulator(), target=pi / 6, duration=0.8),
        0.2,
    ),
]


@dataclass(frozen=True)
class Samples:
    """The plain cycloid on the mesh, in units of the scales: what `--same-start` starts from."""

    boundaries: np.ndarray
    states: np.ndarray
    nodes: np.ndarray
    slack: np.ndarray

    @classmethod
    def of(cls, program: TaskProgram) -> Samples:
        """The plain cycloid's samples, as quietarm's program starts from them."""
        states, outputs = program.program.simulate(
            np.zeros(PROFILE.size), program.task.move, program.scale
        )
        begin, length = (part.full() for part in mesh(_indices(program.steps), program.steps))
        power = outputs[program.program.model.groups[1].where]
        return cls(
            boundaries=np.append(begin, 1.0),
            states=states,
            nodes=(begin + length * np.array(GAUSS_NODES)).ravel(),
            slack=np.abs(power).ravel(order="F") + SLACK_ROOM,
        )


class RockitMove:
    """The move as a rockit user would write it."""

    def __init__(
        self, move: Move, steps: int, scale: np.ndarray, start: Samples | None = None
    ) -> None:
        task = move.task
        self.energy_scale = scale[2] * task.duration
        self.ocp = ocp = rockit.Ocp(T=task.duration)
        W, dW = ocp.state(scale=scale[0]), ocp.state(scale=scale[1])
        slack = ocp.algebraic()
        self.coefficients = [ocp.variable() for _ in range(PROFILE.size)]

        joint = PROFILE.motion(self.coefficients, ocp.t / task.duration, *task.move)
        (ddW,) = task.plant.modal_accelerations(joint, [W], [dW])
        ocp.set_der(W, dW)
        ocp.set_der(dW, ddW)
        power = task.plant.torque(joint, [W], [dW], [ddW]) * joint.speed / scale[2]
        ocp.subject_to(slack >= power, grid="integrator_roots")
        ocp.subject_to(slack >= -power, grid="integrator_roots")
        for state, unit in ((W, scale[0]), (dW, scale[1])):
            ocp.subject_to(ocp.at_t0(state) == 0, scale=unit)
            ocp.subject_to(ocp.at_tf(state) == 0, scale=unit)
        for coefficient in self.coefficients:
            ocp.subject_to(-move.bound <= (coefficient <= move.bound))
        ocp.add_objective(ocp.integral(slack) / task.duration)

        ocp.method(
            rockit.DirectCollocation(
                N=steps, degree=NODES, scheme="legendre", grid=FunctionGrid(_boundaries)
            )
        )
        ocp.solver("ipopt", {"expand": True, "print_time": False, "ipopt": dict(OPTIONS)})
        if start is not None:
            for unknown, times, values in (
                (W, start.boundaries, start.states[0] * scale[0]),
                (dW, start.boundaries, start.states[1] * scale[1]),
                (slack, start.nodes, start.slack),
            ):
                along = ca.interpolant("along", "linear", [times * task.duration], values)
                ocp.set_initial(unknown, along(ocp.t))

    def solve(self) -> rockit.ocp.OcpSolution:
        """Transcribe where that has not been done, and run IPOPT."""
        return self.ocp.solve()

    def energy(self, solution: rockit.ocp.OcpSolution) -> float:
        """F2 [J] by rockit's own quadrature."""
        return float(solution.value(self.ocp.objective)) * self.energy_scale


def _indices(count: int) -> ca.DM:
    return ca.DM(np.arange(count))


def _boundaries(steps: int) -> list[float]:
    return mesh(_indices(steps + 1), steps)[0].full().ravel().tolist()


@dataclass(frozen=True)
class Repetition:
    """Times [s] of one repetition, quietarm first in every pair, and what came out."""

    build_and_solve: tuple[float, float]
    second_call: tuple[float, float]
    solver_alone: tuple[float, float]
    iterations: tuple[int, int]
    energies: tuple[float, float]


def measure(move: Move, steps: int, same_start: bool) -> Repetition:
    """Run quietarm, rockit, quietarm, rockit, ... once each."""

    def plan() -> Plan:
        return plan_move(move.task, PROFILE, bound=move.bound, starts=1, steps=steps)

    def pose_and_solve() -> tuple[RockitMove, rockit.ocp.OcpSolution]:
        posed = RockitMove(move, steps, program.scale, start)
        return posed, posed.solve()

    program = TaskProgram(move.task, PROFILE, steps, with_residual=False)
    start = Samples.of(program) if same_start else None
    forget_compiled()
    ours_cold, answer = timed(plan, process_time)
    theirs_cold, (posed, solution) = timed(pose_and_solve, process_time)
    ours_again, _ = timed(plan, process_time)
    theirs_again, again = timed(posed.solve, process_time)
    program = TaskProgram(move.task, PROFILE, steps, with_residual=False)
    ours_alone, _ = timed(
        lambda: program.solve(np.zeros(PROFILE.size), AT_REST, move.bound), process_time
    )
    return Repetition(
        build_and_solve=(ours_cold, theirs_cold),
        second_call=(ours_again, theirs_again),
        solver_alone=(ours_alone, theirs_again),
        iterations=(
            program.program._cold.stats()["iter_count"],
            again.stats["iter_count"],
        ),
        energies=(answer.verification.fixed_step_energy, posed.energy(solution)),
    )


def show(move: Move, repetitions: list[Repetition]) -> Table:
    """The table of one move."""
    table = Table("", "quietarm", "rockit", "rockit / quietarm", title=move.title)

    def add_times(label: str, pair: Callable[[Repetition], tuple[float, float]]) -> None:
        pairs = [pair(one) for one in repetitions]
        ours, theirs = (median(side) for side in zip(*pairs, strict=True))
        ratio = median(second / first for first, second in pairs)
        table.add_row(label, f"{ours:.3f} s", f"{theirs:.3f} s", f"{ratio:.1f}")

    add_times("build and solve", lambda one: one.build_and_solve)
    add_times("second call", lambda one: one.second_call)
    add_times("solver alone", lambda one: one.solver_alone)
    ours, theirs = repetitions[-1].iterations
    table.add_row("IPOPT iterations", str(ours), str(theirs), "")
    ours, theirs = repetitions[-1].energies
    table.add_row(
        "energy", f"{ours:.8f} J", f"{theirs:.8f} J", f"differ by {abs(theirs / ours - 1):.1e}"
    )
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Plan time against the same problem in rockit.")
    parser.add_argument("--repetitions", type=int, default=5, help="5 by default")
    parser.add_argument("--steps", type=int, default=100, help="steps of three nodes; 100")
    parser.add_argument(
        "--same-start", action="store_true", help="give rockit the plain cycloid's modes, too"
    )
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # rockit's own, on numpy and casadi
    load_plugins()
    screen = console()
    screen.print(machine("rockit-meco"))
    screen.print(
        f"{arguments.steps} steps of {NODES} nodes, {PROFILE.size} terms, one start, median of "
        f"{arguments.repetitions} interleaved repetitions"
    )
    for move in MOVES:
        measure(move, steps=10, same_start=False)  # imports and first calls
        repetitions = [
            measure(move, arguments.steps, arguments.same_start)
            for _ in range(arguments.repetitions)
        ]
        screen.print(show(move, repetitions))


if __name__ == "__main__":
    main()
