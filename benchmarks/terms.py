"""Plans that choose their terms, on random machines within limits: against shapers and the floor.

    python benchmarks/terms.py [--machines 40] [--seed 1] [--output terms.csv]

Machines of 1 to 60 Hz with one mode or two move within 0.6 to 12 periods of the first, within a
limit of the acceleration, and by chance of speed, jerk and torque. Moves that no polynomial of 24
terms makes within the limits are drawn anew, and counted. For each the plan with the terms it
chooses, the floor, and every shaper over cycloid and ruckig that keeps the limits: of those that
leave at most a thousandth of the plain cycloid's residual, or a micrometre, the cheapest. Seconds
are of the processor.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import ruckig  # noqa: F401 - without it its motions would be left out
from parts.measuring import console, machine, timed

from quietarm.models import DualLinkManipulator, Plant, SingleLinkManipulator
from quietarm.ocp import (
    InfeasibleTaskError,
    PointToPoint,
    SolverFailedError,
    energy_floor,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.planning.choose_profile import OF_SIX
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.compare.baselines import CYCLOID, OVER_RUCKIG, RUCKIG, TOPPRA, baseline

AS_STILL, REST, KEPT = 1e-3, 1e-6, 2e-3
"""Shares of the plain cycloid's residual and of a limit, and a residual [m]."""
WITHIN = 0.08
"""Share of the floor that a plan may lie above it."""
FLOOR_STARTS = 2


def random_between(random: np.random.Generator, low: float, high: float) -> float:
    """A number whose logarithm is even between the limits."""
    return float(np.exp(random.uniform(math.log(low), math.log(high))))


def random_machine(random: np.random.Generator, frequency: float, duration: float) -> Plant:
    """A machine of one mode or two, whose friction and modes take their random shares."""
    omega, zeta = 2 * math.pi * frequency, float(random.uniform(0.002, 0.03))
    inertia, push = random_between(random, 1e-3, 0.1), 0.25
    friction = float(random.uniform(0.0, 0.6)) * inertia / duration
    first, second = random.uniform(0.05, 0.45, 2) * inertia / push
    if random.random() < 0.5:
        return SingleLinkManipulator(
            omega=omega, zeta=zeta, beta1=push, alpha1=inertia, alpha2=2 * first, c=friction
        )
    higher = omega * float(random.uniform(1.2, 3.0))
    return DualLinkManipulator(
        omega1=omega, omega2=higher, zeta1=zeta, zeta2=zeta, a1=push, a2=push,
        g1=inertia, g2=first, g3=second, c=friction,
    )  # fmt: skip


def random_task(random: np.random.Generator) -> tuple[PointToPoint, dict[str, float]]:
    """A move of a random machine within limits, and what it was drawn as."""
    frequency, periods = random_between(random, 1, 60), random_between(random, 0.6, 12)
    duration, target = periods / frequency, float(np.radians(random.uniform(10, 120)))
    plant = random_machine(random, frequency, duration)
    hard = random_between(random, 1.8, 15)
    task = PointToPoint(plant, target, duration, acceleration_limit=hard * 4 * target / duration**2)
    cycloid = evaluate_coefficients(task, []).motion
    if random.random() < 0.3:
        task = replace(task, speed_limit=float(random.uniform(1.3, 2.5)) * target / duration)
    if random.random() < 0.3:
        jerk = random_between(random, 3, 30) * 32 * target / duration**3
        task = replace(task, jerk_limit=jerk)
    if random.random() < 0.3:
        torque = float(random.uniform(0.8, 2.0)) * cycloid.peak_torque
        task = replace(task, torque_limit=torque)
    drawn = {"hertz": frequency, "periods": periods, "modes": plant.modes, "acceleration": hard}
    return task, drawn


def cheapest_shaper(task: PointToPoint, residual: float) -> tuple[str, float]:
    """The cheapest motion of today that is as still and keeps the limits, and its energy [J]."""
    allowed = max(residual, REST, AS_STILL * evaluate_coefficients(task, []).residual)
    kept = dict[str, float]()
    for name in (CYCLOID, *SHAPERS, RUCKIG, *OVER_RUCKIG, TOPPRA):
        try:
            motion = baseline(name, task).motion
        except ValueError:  # the shaper is longer than the move, or ruckig finds none
            continue
        if motion.residual <= allowed and not motion.exceeded(task.limits, KEPT):
            kept[name] = motion.energy
    name = min(kept, key=kept.__getitem__, default="")
    return name, kept.get(name, math.inf)


def row_of(task: PointToPoint) -> dict[str, object] | None:
    """The figures of one move; None where no motion keeps the limits."""
    try:
        seconds, plan = timed(lambda: plan_move(task), time.process_time)
    except InfeasibleTaskError:
        return None
    except SolverFailedError as error:
        return {"limits": "+".join(limit.name for limit in task.limits), "failed": str(error)}
    smooth = task.jerk_limit is not None  # a free acceleration jumps
    name, shaper = cheapest_shaper(task, plan.residual)
    try:
        floor = energy_floor(task, smooth=smooth, starts=FLOOR_STARTS).energy
    except SolverFailedError:
        floor = math.nan
    six = plan.record.settings.get(OF_SIX, math.nan)
    return {
        "limits": "+".join(limit.name for limit in task.limits), "terms": plan.profile.size,
        "plan_J": plan.energy,
        "above_floor": plan.energy / floor - 1, "six_above_floor": float(six or 0) / floor - 1,
        "shaper": name, "shaper_above_plan": shaper / plan.energy - 1,
        "residual_m": plan.residual, "seconds": seconds,
    }  # fmt: skip


def main() -> None:
    """Print a row for each machine, and what holds of all."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--machines", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path)
    asked = parser.parse_args()
    random, screen = np.random.default_rng(asked.seed), console()
    screen.print(machine())
    rows, infeasible = list[dict[str, object]](), 0
    while len(rows) < asked.machines:
        task, drawn = random_task(random)
        row = row_of(task)
        if row is None:
            infeasible += 1
            continue
        rows.append({**drawn, **row})
        values = (f"{one:.3g}" if isinstance(one, float) else one for one in rows[-1].values())
        screen.print(*values, soft_wrap=True)
    table = pd.DataFrame(rows)
    near = int((table["above_floor"] <= WITHIN).sum())
    screen.print(
        f"{len(table)} machines, {infeasible} drawn anew; "
        f"{int((table['shaper_above_plan'] < 0).sum())} with a cheaper shaper; "
        f"{near} within {WITHIN:.0%} of the floor (six terms: "
        f"{int((table['six_above_floor'] <= WITHIN).sum())}), the worst "
        f"{table['above_floor'].max():.1%} above; a plan takes {table['seconds'].median():.2f} s, "
        f"at most {table['seconds'].max():.2f} s"
    )
    if asked.output:
        table.to_csv(asked.output, index=False)


if __name__ == "__main__":
    main()
