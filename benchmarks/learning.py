"""Measure what moves leave while a plan is learned from them, on machines beyond the model.

    pip install ".[benchmark]"
    python benchmarks/learning.py [--machine gantry picker] [--seeds 10] [--output learning.csv]

The machines are those of `parts/drive`: finite elements, servo, friction, belt, encoder, dead time.
Each move is recorded at 1 kHz with noise, from a random time before it, and `quietarm.learn` makes
the next plan of it. The csv has a row for every case and seed, with what each move left and what
was predicted for it. A seed is written as soon as it is done; the same line goes on after it.
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
from parts.measuring import console, machine

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
MOVES_LEARNED = 3
TIP = ("tip", "angle")
JOINT = ("angle", "torque")
COLUMNS = (
    "machine", "case", "signals", "recordings", "seed",
    *(f"mm_{move}" for move in range(1 + MOVES_LEARNED)),
    *(f"said_mm_{move}" for move in range(1, 1 + MOVES_LEARNED)), "energy_j", "refused",
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
    resolution
        Of the laser [m], and a hundredth of it of the encoder, where that is coarser.
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
    resolution: float = 1e-7
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
    Case("friction three times, model 8 % too slow", error=-0.08, dry=3.0),
    Case("noise ten times, steps of 0.1 mm, model 8 % too slow", error=-0.08, noise=10.0,
         resolution=1e-4),
    Case("backlash of 0.05 mm, model 8 % too slow", error=-0.08, backlash=5e-5),
    Case("payload varies by 10 %", tools=0.1),
    Case("payload varies by 10 %", tools=0.1, recordings=3),
)  # fmt: skip
"""What is asked of every seed."""


@dataclass
class Course:
    """One case from one seed: the plan that is executed next, and what each move left [m].

    `acts` has when the tool may act [s]: from then on it stays within 0.1 mm.
    """

    case: Case
    plan: Plan
    random: np.random.Generator
    residuals: list[float] = field(default_factory=list)
    predicted: list[float] = field(default_factory=list)
    energies: list[float] = field(default_factory=list)
    acts: list[float] = field(default_factory=list)
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
    quantum = max(actual.servo.quantum, 0.01 * case.resolution)
    step = case.resolution
    largest = actual.servo.largest
    signals = {
        "tip": np.round(tip / step) * step,
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
        course.acts.append(float(np.max([found[k].acts_after for k in own])))
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


def row_of(move: Move, course: Course, seed: int) -> list[str]:
    """The row of the csv for one course."""
    case = course.case
    return [
        move.machine.name, case.name, "+".join(case.signals), str(case.recordings), str(seed),
        *(f"{1e3 * left:.3g}" for left in course.residuals),
        *(f"{1e3 * said:.3g}" for said in course.predicted),
        f"{course.energies[-1]:.4g}", course.refused,
    ]  # fmt: skip


def courses_of(move: Move, seed: int, plans: dict[float, Plan]) -> list[Course]:
    """A course of every case that the machine can have."""
    return [
        Course(case, plans[case.error], np.random.default_rng(seed))
        for case in CASES
        if not (case.backlash and move.machine.belt is None)
    ]


def done_in(path: Path) -> set[tuple[str, str]]:
    """The machines and seeds that a csv has."""
    if not path.exists():
        return set()
    with path.open(newline="") as file:
        return {(row["machine"], row["seed"]) for row in csv.DictReader(file)}


def main() -> None:
    """Learn every case from every seed that the csv does not have, and write it there."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--output", type=Path, default=RESULTS, help="csv to write")
    options = parser.parse_args()
    out = console()
    out.print(machine())
    known = done_in(options.output)
    if not known:
        options.output.write_text(",".join(COLUMNS) + "\n")
    plans = {
        name: {error: first_plan(MOVES[name], error) for error in (0.0, -0.08, 0.08)}
        for name in options.machine
    }
    for seed in range(options.seeds):
        for name in options.machine:
            if (name, str(seed)) in known:
                continue
            courses = courses_of(MOVES[name], seed, plans[name])
            for number in range(1 + MOVES_LEARNED):
                march(MOVES[name], courses, last=number == MOVES_LEARNED)
            rows = [row_of(MOVES[name], course, seed) for course in courses]
            with options.output.open("a", newline="") as file:
                csv.writer(file, lineterminator="\n").writerows(rows)
            out.print(f"{name}: seed {seed}")


if __name__ == "__main__":
    main()
