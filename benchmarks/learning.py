"""What moves leave while a plan is learned from them: machines that are not quietarm's model.

    pip install ".[benchmark]"
    python benchmarks/learning.py [--machine gantry picker] [--seeds 10] [--output learning.csv]

The machines are those of `parts/drive`: finite elements, servo, friction, belt, encoder, dead time.
Each move is recorded at 1 kHz with noise, from a random time before it, and `quietarm.learn` makes
the next plan of it. The csv has a row for every move: the largest and the median residual of the
seeds, what was predicted for it, and the energy of its plan.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from parts.drive.machines import Machine
from parts.drive.measures import outcomes
from parts.drive.moves import MOVES, Move
from parts.drive.recordings import identified
from parts.drive.simulate import TICKS, Runs, SetPoints, simulate
from parts.measuring import console, machine, timed

from quietarm import Plan, QuietarmError, Recording, learn, plan_move

RESULTS = Path(__file__).parent / "results" / "learning.csv"
REST = 1.2
"""Seconds that are recorded after a move."""
EVERY = 4
"""Ticks of the servo between two samples of a recording."""
FORCE_NOISE = 0.003
"""Standard deviation of the recorded force, as a share of the drive's largest."""
EARLIEST = 0.2
"""A recording begins up to so many seconds before its move."""
MOVES_LEARNED = 4
TIP = ("tip", "angle")
JOINT = ("angle", "torque")
COLUMNS = (
    "machine", "case", "signals", "recordings", "move", "seeds", "median_mm", "largest_mm",
    "within_predicted", "energy_j", "refused",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A machine, the model that its user has, and what is recorded.

    Parameters
    ----------
    name
        What differs.
    error
        Share by which the model's frequency is wrong.
    signals
        What is recorded.
    recordings
        Of every move.
    dry
        Factor of the dry friction.
    noise
        Factor of the laser's noise.
    backlash
        Of the belt [m].
    tools
        Standard deviation of the tool's mass from move to move, as a share.
    """

    name: str
    error: float = 0.0
    signals: Sequence[str] = TIP
    recordings: int = 1
    dry: float = 1.0
    noise: float = 1.0
    backlash: float = 0.0
    tools: float = 0.0

    def actual(self, of: Machine, random: np.random.Generator) -> Machine:
        """The machine that makes a move."""
        varied = replace(
            of,
            motor_friction=of.motor_friction.times(self.dry),
            guide_friction=of.guide_friction.times(self.dry),
            backlash=self.backlash if of.belt is not None else 0.0,
        )
        if self.tools:
            return replace(varied, tool=1 + float(random.normal(0, self.tools)))
        return varied


CASES = (
    Case("right model"),
    Case("model 8 % too slow", error=-0.08),
    Case("model 8 % too fast", error=0.08),
    Case("right model", signals=JOINT),
    Case("model 8 % too slow", error=-0.08, signals=JOINT),
    Case("model 8 % too fast", error=0.08, signals=JOINT),
)
"""What is asked of every seed."""
HARDER = (
    Case("friction three times", dry=3.0),
    Case("friction three times, model 8 % too slow", error=-0.08, dry=3.0),
    Case("noise ten times", noise=10.0),
    Case("backlash of 0.05 mm", backlash=5e-5),
    Case("backlash of 0.05 mm, model 8 % too slow", error=-0.08, backlash=5e-5),
    Case("tool varies by 10 %", tools=0.1),
    Case("tool varies by 10 %", tools=0.1, recordings=3),
)
"""What is asked of the first three seeds."""


@dataclass
class Course:
    """One case from one seed: the plan that is executed next, and what each move left [m]."""

    case: Case
    plan: Plan
    random: np.random.Generator
    residuals: list[float] = field(default_factory=list)
    predicted: list[float] = field(default_factory=list)
    energies: list[float] = field(default_factory=list)
    refused: str = ""


def set_points(plan: Plan) -> SetPoints:
    """The rows of a plan at 1 kHz."""
    time = np.arange(int(np.ceil(1000 * plan.task.duration - 1e-6)) + 1) / 1000
    return SetPoints(time, *plan.sampled(time).joint.T)


def recorded(course: Course, move: Move, actual: Machine, runs: Runs, column: int) -> Recording:
    """One run as a user records it."""
    case, random = course.case, course.random
    before = int(random.integers(0, EARLIEST * TICKS))
    begin = before % EVERY
    count = len(range(begin, before + len(runs.time), EVERY))

    def seen(values: np.ndarray) -> np.ndarray:
        return np.concatenate([np.full(before, values[0]), values])[begin::EVERY]

    tip = seen(runs.tool[:, column]) + random.normal(0, case.noise * move.noise, count)
    quantum = actual.servo.quantum
    largest = actual.servo.largest
    signals = {
        "tip": tip.round(7),
        "angle": np.round(seen(runs.motor[:, column]) / quantum) * quantum,
        "torque": seen(runs.force[:, column]) + random.normal(0, FORCE_NOISE * largest, count),
    }
    kept = {name: signals[name] for name in case.signals}
    return Recording(np.arange(count) * EVERY / TICKS, **kept)


def march(move: Move, courses: Sequence[Course], last: bool) -> None:
    """All courses make their next move, side by side, and learn from it unless it is the last."""
    planned = [course for course in courses for _ in range(course.case.recordings)]
    actual = [course.case.actual(move.machine, course.random) for course in planned]
    asked = [set_points(course.plan) for course in planned]
    runs = simulate(actual, asked, rest=REST)
    found = outcomes(runs, actual, asked, [1e-4] * len(asked))
    for course in courses:
        own = [k for k, one in enumerate(planned) if one is course]
        course.residuals.append(float(np.mean([found[k].residual for k in own])))
        course.energies.append(float(np.mean([found[k].energy for k in own])))
        if last:
            continue
        recordings = [recorded(course, move, actual[k], runs, k) for k in own]
        try:
            learned = learn(course.plan, recordings)
        except (ValueError, QuietarmError) as error:
            course.refused = str(error)
            course.predicted.append(np.nan)
        else:
            course.plan = learned.plan
            course.predicted.append(learned.next_at_most)


def first_plan(move: Move, error: float) -> Plan:
    """The plan of a model whose identified frequency is wrong by a share."""
    frequency, damping, _ = identified("on the way", move, move.machine)
    duration = move.shortest("zvd", frequency, damping)
    return plan_move(move.task(frequency * (1 + error), damping, duration))


def rows_of(move: Move, courses: Sequence[Course]) -> list[list[str]]:
    """Rows of the csv for the courses of one case, a move each."""
    case = courses[0].case
    rows = list[list[str]]()
    for number in range(len(courses[0].residuals)):
        left = np.array([course.residuals[number] for course in courses])
        within = ""
        if number:
            said = np.array([course.predicted[number - 1] for course in courses])
            within = f"{np.mean(left <= said):.2f}"
        energy = np.median([course.energies[number] for course in courses])
        refused = sum(bool(course.refused) for course in courses)
        rows.append([
            move.machine.name, case.name, "+".join(case.signals), str(case.recordings),
            str(number), str(len(courses)), f"{1e3 * np.median(left):.3g}",
            f"{1e3 * left.max():.3g}", within, f"{energy:.4g}", str(refused),
        ])  # fmt: skip
    return rows


def main() -> None:
    """Learn every case from every seed, and write the csv."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--harder-seeds", type=int, default=3)
    parser.add_argument("--output", type=Path, default=RESULTS, help="csv to write")
    options = parser.parse_args()
    out = console()
    out.print(machine())
    table = list[list[str]]()
    for name in options.machine:
        move = MOVES[name]
        plans = {error: first_plan(move, error) for error in (0.0, -0.08, 0.08)}
        seeds = [(case, options.seeds) for case in CASES]
        seeds += [(case, options.harder_seeds) for case in HARDER]
        groups = [
            [Course(case, plans[case.error], np.random.default_rng(seed)) for seed in range(count)]
            for case, count in seeds
            if count and not (case.backlash and move.machine.belt is None)
        ]
        courses = [course for group in groups for course in group]
        for number in range(1 + MOVES_LEARNED):
            last = number == MOVES_LEARNED
            seconds, _ = timed(lambda last=last: march(move, courses, last))  # noqa: B023
            out.print(f"{name}: move {number} of {len(courses)} courses in {seconds:.0f} s")
        for group in groups:
            rows = rows_of(move, group)
            table += rows
            for row in rows:
                out.print(" ".join(row))
            for course in group:
                if course.refused:
                    out.print(course.refused)
    with options.output.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *table])
    out.print(f"wrote {options.output}")


if __name__ == "__main__":
    main()
