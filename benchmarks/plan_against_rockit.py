"""Plan time against the same problem in rockit-meco, at equal error of the energy.

    pip install ".[benchmark]"
    python benchmarks/plan_against_rockit.py [--repetitions 5] [--within 1e-4]

The moves of `parts/conditions.py` without limits on peaks: the paper's six conditions in its boxes
and three others without a box; six terms, at rest on arrival. Both sides

- take the equations from the same lines: the plant's own methods and the profile's `motion`;
- take steps of three Gauss nodes on the same graded mesh (rockit: `DirectCollocation` of degree 3,
  scheme "legendre", on a `FunctionGrid`);
- measure states and power in the same units, and run IPOPT;
- start with all coefficients zero, and from nowhere else.

rockit makes |power| exact by a slack at every node (an algebraic variable s with s >= p, s >= -p on
the grid "integrator_roots") and minimises its quadrature, which knows nothing of sign changes
between the nodes; quietarm resolves these. So at equal steps quietarm's motion is the better one,
and each side gets the fewest steps of a list with which the true energy of its motion, by CVODES,
is within 1e-4 of the best known: that of `plan_move` from four starts with 200 steps. Where no
number of steps is enough, the largest is used, as the row "energy / best - 1" shows.

rockit runs with `expand`, as in its own examples: without it, it takes several times as long. Its
IPOPT has the options of quietarm's and the tolerance of quietarm's first, sampled run, 1e-5; a
tighter one hardly changes its iterations or its energies.

Times are the processor's, not the wall clock's: everything here runs on one thread, where the two
are the same on an idle machine, and other work on a shared one disturbs the processor's less.
Printed are medians over interleaved repetitions, and the median of the ratios within a repetition:

- build and solve: everything from the task to the coefficients, nothing built before. quietarm's
  time is `plan_move`'s and includes the verification by CVODES, which rockit does not have;
- second call: the same again with all built, `plan_move` against `quietarm.ocp.solve`;
- solver alone: the second solve with these steps, without the verification.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import process_time

import numpy as np
import rockit
from parts.conditions import conditions
from parts.measuring import console, forget_compiled, load_plugins, machine, timed
from rich.table import Table
from rockit.sampling_method import FunctionGrid

from quietarm.ocp import CycloidPolynomial, Plan, PointToPoint, plan_move
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.solvers.nlp import OPTIONS
from quietarm.ocp.solvers.problem import (
    Program,
    Solution,
)
from quietarm.ocp.solvers.sqp import Sqp

PROFILE = CycloidPolynomial(6)
STEPS = (16, 24, 32, 50, 100, 200)
TOLERANCE = 1e-5
QUANTITIES = ("build and solve", "second call", "solver alone")


@dataclass(frozen=True)
class Move:
    """A move, the box on its coefficients, units of W, W' and power, and the least energy [J]."""

    title: str
    task: PointToPoint
    bound: float | None
    scale: np.ndarray
    best: float

    @classmethod
    def of(cls, title: str, task: PointToPoint, bound: float | None) -> Move:
        """The move with what is known of it before."""
        best = plan_move(task, PROFILE, bound=bound, steps=STEPS[-1])
        steps = Program(task, PROFILE, STEPS[-1])
        scale = np.append(steps.arrival_scale, steps.energy_scale / task.duration)
        return cls(title, task, bound, scale, best.energy)

    def above(self, coefficients: np.ndarray) -> float:
        """Return how far the true energy of a motion is above the best, relative."""
        return JudgedMotion.of_profile(self.task, PROFILE, coefficients).energy / self.best - 1

    def plan(self) -> Plan:
        """Plan by quietarm, as a user would, with the verification."""
        return plan_move(self.task, PROFILE, bound=self.bound, starts=1)

    def solve(self, steps: int) -> Solution:
        """Solve by quietarm, without the verification."""
        problem = Program(self.task, PROFILE, steps).within(0.0, self.bound)
        (solution,) = Sqp().solve([problem], [PROFILE.plain])
        return solution


class RockitMove:
    """The move as a rockit user would write it."""

    def __init__(self, move: Move, steps: int) -> None:
        task, scale = move.task, move.scale
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
        if (bound := move.bound) is not None:
            for coefficient in self.coefficients:
                ocp.subject_to(-bound <= (coefficient <= bound))
        ocp.add_objective(ocp.integral(slack) / task.duration)

        boundaries = _boundaries(steps)
        ocp.method(
            rockit.DirectCollocation(
                N=steps,
                degree=NODES,
                scheme="legendre",
                grid=FunctionGrid(lambda count: boundaries),
            )
        )
        options = {**OPTIONS, "tol": TOLERANCE}
        ocp.solver("ipopt", {"expand": True, "print_time": False, "ipopt": options})

    def solve(self) -> rockit.ocp.OcpSolution:
        """Transcribe where that has not been done, and run IPOPT."""
        return self.ocp.solve()

    def found(self) -> np.ndarray:
        """Solve for the coefficients."""
        solution = self.solve()
        return np.array([float(solution.value(unknown)) for unknown in self.coefficients])


def _boundaries(steps: int) -> list[float]:
    return Mesh(steps).boundaries.tolist()


def fewest(above: Callable[[int], float], within: float) -> int:
    """The fewest steps with which a side's true energy is as good as asked; else the most."""
    return next((steps for steps in STEPS if abs(above(steps)) <= within), STEPS[-1])


@dataclass(frozen=True)
class Repetition:
    """Times [s] of one repetition, quietarm first in every pair, and what came out."""

    times: dict[str, tuple[float, float]]
    iterations: tuple[int, int]
    above: tuple[float, float]


def measure(move: Move, steps: tuple[int, int]) -> Repetition:
    """Run quietarm, rockit, quietarm, rockit, ... once each."""
    ours, theirs = steps

    def pose_and_solve() -> RockitMove:
        posed = RockitMove(move, theirs)
        posed.solve()
        return posed

    forget_compiled()
    ours_cold, _ = timed(lambda: move.plan(), process_time)
    theirs_cold, posed = timed(pose_and_solve, process_time)
    ours_again, _ = timed(lambda: move.plan(), process_time)
    theirs_again, again = timed(posed.solve, process_time)
    move.solve(ours)  # builds what it needs
    ours_alone, solution = timed(lambda: move.solve(ours), process_time)
    pairs = ((ours_cold, theirs_cold), (ours_again, theirs_again), (ours_alone, theirs_again))
    return Repetition(
        times=dict(zip(QUANTITIES, pairs, strict=True)),
        iterations=(solution.iterations, again.stats["iter_count"]),
        above=(move.above(solution.coefficients), move.above(posed.found())),
    )


def move_table(move: Move, steps: tuple[int, int], repetitions: list[Repetition]) -> Table:
    """The table of one move."""
    title = f"{move.title}: {move.best:.6f} J"
    table = Table("", "quietarm", "rockit", "rockit / quietarm", title=title)
    table.add_row("steps", *map(str, steps))
    for name in QUANTITIES:
        pairs = [one.times[name] for one in repetitions]
        ours, theirs = (median(side) for side in zip(*pairs, strict=True))
        ratio = median(second / first for first, second in pairs)
        table.add_row(name, f"{ours:.3f} s", f"{theirs:.3f} s", f"{ratio:.1f}")
    last = repetitions[-1]
    table.add_row("iterations", *map(str, last.iterations))
    table.add_row("energy / best - 1", *(f"{one:+.1e}" for one in last.above))
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Plan time against the same problem in rockit.")
    parser.add_argument("--repetitions", type=int, default=5, help="5 by default")
    parser.add_argument("--within", type=float, default=1e-4, help="error of the energy; 1e-4")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # rockit's own, on numpy and casadi
    load_plugins()
    screen = console()
    screen.print(machine("rockit-meco"))
    screen.print(f"one start, median of {arguments.repetitions}, within {arguments.within:g}")
    for title, (task, bound) in conditions().items():
        if task.limits:
            continue
        move = Move.of(title, task, bound)
        steps = (
            fewest(lambda n: move.above(move.solve(n).coefficients), arguments.within),  # noqa: B023
            fewest(lambda n: move.above(RockitMove(move, n).found()), arguments.within),  # noqa: B023
        )
        repetitions = [measure(move, steps) for _ in range(arguments.repetitions)]
        screen.print(move_table(move, steps, repetitions))


if __name__ == "__main__":
    main()
