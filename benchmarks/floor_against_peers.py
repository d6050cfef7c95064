"""The floor's transcription against the same problem in rockit-meco and in yapss.

    python -m venv peers && peers/bin/pip install ".[peers]"
    peers/bin/python benchmarks/floor_against_peers.py [--repetitions 3] [--steps 25 50 100 ...]

The least-energy motion of the arm on a flexible link, 0 to pi/2 in 0.8 s, at rest at both ends,
|theta''| <= 200 rad/s^2, over all joint motions. An environment of its own, since yapss 0.2.3 asks
for casadi up to 3.7.2; all three run on that casadi and its IPOPT, in one process. Without yapss
its rows are left out.

All sides

- take the equations from the same lines, the plant's own methods;
- minimise the integral of a slack s with s >= p and s >= -p at every collocation point;
- measure the unknowns in units of about their size, and run IPOPT with the same options;
- start from the plain cycloid's angle, speed and acceleration and from modes at rest (quietarm: the
  modes and slacks that go with them, which it computes anyway).

quietarm and rockit (`DirectCollocation` of degree 3, scheme "legendre", `FunctionGrid`) have a
constant acceleration on each interval of the same grid: the same discretisation. yapss has its own,
Legendre-Gauss-Lobatto of two points a segment on the same grid: trapezoids, with an acceleration
that is linear on each segment and continuous. Of its methods this is the best one here: those with
more points a segment leave the acceleration as many freedoms as there are samples of the power, and
hide energy between them (with three points, a fifth of it).

The error is that of the energy: of the transcription's own, and of a re-simulation of its joint
motion with CVODES, both against the reference, quietarm's floor refined until it changes by less
than 1e-4. Times are the processor's, medians over interleaved repetitions, from the task to the
solution with nothing built before. A side that has met the smallest bound on both errors is not run
on finer grids. The last table takes for each side the coarsest of these grids that meets a bound.
"""

from __future__ import annotations

import argparse
import io
import warnings
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from math import pi
from statistics import median
from time import process_time

import casadi as ca
import numpy as np
import rockit
from parts.measuring import console, forget_compiled, load_plugins, machine, timed
from rich.table import Table
from rockit.sampling_method import FunctionGrid

from quietarm.models import ArmOnFlexibleLink, JointMotion
from quietarm.ocp import CycloidPolynomial, PointToPoint, energy_floor
from quietarm.ocp.floor.program import COLD, FloorProgram, first_grid
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.collocation import NODES

try:
    import yapss
except ImportError:
    yapss = None

LIMIT = 200.0
TASK = PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8, acceleration_limit=LIMIT)
CYCLOID = CycloidPolynomial(0).path([], *TASK.move)
UNITS = np.array([pi / 2, 4.0, 1e-2, 0.1, 25.0, 0.5])
"""Of angle, speed, W, W', acceleration and power: about what the plain cycloid reaches."""
BOUNDS = (0.02, 0.01, 0.005)


@dataclass(frozen=True)
class Answer:
    """Answer of one side: its own energy [J], its motion, IPOPT's iterations."""

    energy: float
    free: FreeMotion
    iterations: int | None


def power_of(
    angle: ca.SX, speed: ca.SX, W: ca.SX, dW: ca.SX, acceleration: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """W'' [m/s^2] and the power [W], by the plant's own methods."""
    joint = JointMotion(angle, speed, acceleration)
    (ddW,) = TASK.plant.modal_accelerations(joint, [W], [dW])
    return ddW, TASK.plant.torque(joint, [W], [dW], [ddW]) * speed


def by_quietarm(steps: int) -> Answer:
    """The floor's own transcription on one grid."""
    program = FloorProgram(TASK, smooth=False)
    found = program.solve(program.along(CYCLOID, first_grid(steps)), TASK.limits)
    if not found.status.solved:
        raise RuntimeError(found.status.text)
    return Answer(found.energy, found.free, found.iterations)


def by_rockit(steps: int) -> Answer:
    """The problem as a rockit user would write it."""
    ocp = rockit.Ocp(T=TASK.duration)
    states = [ocp.state(scale=unit) for unit in UNITS[:4]]
    angle, speed, W, dW = states
    acceleration, slack = ocp.control(scale=UNITS[4]), ocp.algebraic(scale=UNITS[5])
    ddW, power = power_of(angle, speed, W, dW, acceleration)
    for state, rate in zip(states, (speed, acceleration, dW, ddW), strict=True):
        ocp.set_der(state, rate)
    ocp.subject_to(slack >= power, grid="integrator_roots", scale=UNITS[5])
    ocp.subject_to(slack >= -power, grid="integrator_roots", scale=UNITS[5])
    limit = LIMIT
    ocp.subject_to(-limit <= (acceleration <= limit), scale=UNITS[4])
    for state, unit, last in zip(states, UNITS, (TASK.target, 0, 0, 0), strict=False):
        ocp.subject_to(ocp.at_t0(state) == 0, scale=unit)
        ocp.subject_to(ocp.at_tf(state) == last, scale=unit)
    ocp.add_objective(ocp.integral(slack))
    for unknown, value in zip((angle, speed, acceleration), _cycloid_at(ocp.t), strict=True):
        ocp.set_initial(unknown, value)
    grid = first_grid(steps).tolist()
    ocp.method(
        rockit.DirectCollocation(
            N=steps, degree=NODES, scheme="legendre", grid=FunctionGrid(lambda _: grid)
        )
    )
    ocp.solver("ipopt", {"expand": True, "print_time": False, "ipopt": dict(COLD)})
    with redirect_stdout(io.StringIO()):  # it prints the constraints that it scales
        solution = ocp.solve()
    times, values = solution.sample(acceleration, grid="control")
    return Answer(
        float(solution.value(ocp.objective)),
        FreeMotion(times, values[:-1], np.zeros(steps)),
        int(solution.stats["iter_count"]),
    )


def _cycloid_at(t: ca.MX) -> list[ca.MX]:
    phase = 2 * pi * t / TASK.duration
    rate = TASK.span / TASK.duration
    return [
        rate * t - TASK.span * ca.sin(phase) / (2 * pi),
        rate * (1 - ca.cos(phase)),
        2 * pi * rate / TASK.duration * ca.sin(phase),
    ]


def by_yapss(steps: int) -> Answer:
    """The problem as a yapss user would write it, in scaled unknowns."""
    problem = yapss.Problem(name="floor", nx=[4], nu=[2], nq=[1], nh=[2])
    units, T = UNITS, TASK.duration

    def objective(arg: yapss.ObjectiveArg) -> None:
        arg.objective = arg.phase[0].integral[0]

    def continuous(arg: yapss.ContinuousArg) -> None:
        phase = arg.phase[0]
        scaled = [*phase.state, *phase.control]  # arrays of one symbol, wrapped
        entries = [ca.SX(entry.item()._value) for entry in scaled]
        angle, speed, W, dW, acceleration = (
            entry * unit for entry, unit in zip(entries[:5], units, strict=False)
        )
        ddW, power = power_of(angle, speed, W, dW, acceleration)
        rates = (speed, acceleration, dW, ddW)
        wrap = type(scaled[0].item())
        phase.dynamics[:] = [wrap(rate / unit) for rate, unit in zip(rates, units, strict=False)]
        phase.path[:] = [wrap(entries[5] - power / units[5]), wrap(entries[5] + power / units[5])]
        phase.integrand[:] = [wrap(entries[5])]

    problem.functions.objective, problem.functions.continuous = objective, continuous
    bounds = problem.bounds.phase[0]
    bounds.initial_time.lower = bounds.initial_time.upper = 0.0
    bounds.final_time.lower = bounds.final_time.upper = T
    bounds.initial_state.lower = bounds.initial_state.upper = np.zeros(4)
    last = np.array([TASK.target / units[0], 0.0, 0.0, 0.0])
    bounds.final_state.lower = bounds.final_state.upper = last
    bounds.control.lower = np.array([-LIMIT / units[4], -np.inf])
    bounds.control.upper = np.array([LIMIT / units[4], np.inf])
    bounds.path.lower = np.zeros(2)
    times = np.linspace(0.0, T, 101)
    joint = [CYCLOID(times, order) for order in range(3)]
    guess, still = problem.guess.phase[0], np.zeros(len(times))
    guess.time = times
    guess.state = np.array([joint[0] / units[0], joint[1] / units[1], still, still])
    guess.control = np.array([joint[2] / units[4], still + 0.5])
    grid = first_grid(steps)
    problem.mesh.phase[0].collocation_points = (2,) * steps
    problem.mesh.phase[0].fraction = tuple(np.diff(grid).tolist())
    problem.spectral_method = "lgl"
    problem.derivatives.method, problem.derivatives.order = "auto", "second"
    for name, value in COLD.items():
        setattr(problem.ipopt_options, name, value)
    solution = problem.solve()
    info = solution.nlp_info
    if info.ipopt_status != 0:
        raise RuntimeError(info.ipopt_status_message)
    values, times = np.asarray(solution.phase[0].control[0]) * units[4], grid * T
    return Answer(
        float(solution.objective) * units[5],
        FreeMotion(times, values[:-1], np.diff(values) / np.diff(times)),
        None,
    )


@dataclass(frozen=True)
class Row:
    """One side on one grid: median time [s], errors of its own and of the re-simulated energy."""

    side: str
    steps: int
    seconds: float
    energy: float
    own_error: float
    true_error: float
    iterations: int | None

    @property
    def error(self) -> float:
        """The larger one of the two."""
        return max(abs(self.own_error), abs(self.true_error))


def resimulated_energy(free: FreeMotion) -> float:
    """F2 of a free motion by CVODES [J]."""
    return JudgedMotion.of_free_motion(TASK, free).energy


def measure(
    sides: dict[str, Callable[[int], Answer]], steps: int, repetitions: int, reference: float
) -> list[Row]:
    """Run the sides in turn, as often as asked."""
    seconds: dict[str, list[float]] = {name: [] for name in sides}
    answers: dict[str, Answer] = {}
    for _ in range(repetitions):
        for name, side in sides.items():
            forget_compiled()
            taken, answers[name] = timed(lambda side=side: side(steps), process_time)
            seconds[name].append(taken)
    return [
        Row(
            name,
            steps,
            median(seconds[name]),
            answer.energy,
            answer.energy / reference - 1,
            resimulated_energy(answer.free) / reference - 1,
            answer.iterations,
        )
        for name, answer in answers.items()
    ]


def grid_table(rows: list[Row]) -> Table:
    """Every run."""
    table = Table(
        "intervals", "side", r"build and solve \[s]", "/ quietarm", "IPOPT iterations",
        "energy [J]", "own error", "error by CVODES",
    )  # fmt: skip
    ours = {row.steps: row.seconds for row in rows if row.side == "quietarm"}

    def ratio(row: Row) -> str:
        return f"{row.seconds / ours[row.steps]:.1f}" if row.steps in ours else ""

    for row in rows:
        table.add_row(
            str(row.steps), row.side, f"{row.seconds:.3f}", ratio(row),
            str(row.iterations or ""), f"{row.energy:.6f}",
            f"{row.own_error:+.2%}", f"{row.true_error:+.2%}",
        )  # fmt: skip
    return table


def equal_error_table(rows: list[Row]) -> Table:
    """The coarsest grid on which each side is within a bound."""
    table = Table("energy within", "side", "intervals", r"build and solve \[s]", "/ quietarm")
    for bound in BOUNDS:
        chosen: dict[str, Row] = {}
        for row in rows:
            if row.error <= bound:
                chosen.setdefault(row.side, row)
        for side, row in chosen.items():
            ratio = row.seconds / chosen["quietarm"].seconds if "quietarm" in chosen else np.nan
            table.add_row(
                f"{bound:.1%}", side, str(row.steps), f"{row.seconds:.3f}", f"{ratio:.1f}"
            )
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="The floor against the same problem elsewhere.")
    parser.add_argument("--repetitions", type=int, default=3, help="3 by default")
    parser.add_argument("--steps", type=int, nargs="+", default=[25, 50, 100, 200, 400, 800])
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # rockit's own, on numpy and casadi
    load_plugins()
    sides: dict[str, Callable[[int], Answer]] = {"quietarm": by_quietarm, "rockit": by_rockit}
    if yapss is not None:
        sides["yapss"] = by_yapss
    screen = console()
    screen.print(machine("rockit-meco", *(["yapss"] if yapss else [])))
    floor = energy_floor(TASK, energy_tolerance=1e-4)
    screen.print(
        f"reference {floor.energy:.6f} J, {floor.free.steps} intervals, "
        f"error {floor.discretisation_error:.1e} J"
    )
    rows: list[Row] = []
    for steps in sorted(arguments.steps):
        found = measure(sides, steps, arguments.repetitions, floor.energy)
        rows += found
        for row in found:
            if row.error <= min(BOUNDS):
                del sides[row.side]
    screen.print(grid_table(rows))
    screen.print(equal_error_table(rows))


if __name__ == "__main__":
    main()
