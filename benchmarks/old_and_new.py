"""Plans and fronts by two versions of quietarm in one run: time ratios and energies.

    python benchmarks/old_and_new.py [--old a41b84d] [--repetitions 3] [--only plans fronts ...]

The old version is taken from this repository's history into a temporary folder; nothing needs to be
installed for it. Each version runs in a process of its own, the two in turn, so that other load on
the machine affects both alike. Only functions that both have are called: `plan_move`,
`epsilon_front`, `energy_floor`, `search`, `PopulationObjective`; the new version's `plan_moves` is
held against a loop of the old one's `plan_move`. Times are the processor's. Printed
are medians, the ratio old / new, and how much higher (+) or lower (-) the new energies are, all by
each version's own CVODES figures.

- plans: the second plan of the same shape, one start, six terms; the paper's six conditions in its
  boxes and four others.
- fronts: 50 points by the epsilon constraint; the same conditions.
- hard: 20 terms, all limits at once, two modes; one start, second plan.
- modes: plants of 1 to 12 modes at rest on arrival, 2 x modes + 4 terms, first plan of its shape.
- floors: two conditions of the link and three of the arm, free accelerations and smooth.
- searches: NSGA-II with 200 candidates and VEPSO with 2 x 100, for 60 generations.
- population: 100 calls with 200 candidates, functions built before, on the paper's six conditions.
- robust: plans of 60 random machines (three plants, 1.5 to 4.5 Hz, 0.55 to 1 s, frequency 5 to 10 %
  wrong, every second one with limits of torque and acceleration), at most 5 % of how far the plain
  cycloid bends the tip; first plan of its shape.
- moves: 400 moves of each plant at rest on arrival, all at once, against as many plans (the old
  version plans 40 of them; its time is that times ten).
- starts, only if asked for: in how many of 40 seeds (of the old version: 4) the default four starts
  find the best plan; the paper's six conditions and ten others, 6 and 10 terms, with and without a
  box.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tarfile
import tempfile
import time
from dataclasses import dataclass
from io import BytesIO
from math import pi
from pathlib import Path
from statistics import median
from typing import ClassVar

ROOT = Path(__file__).resolve().parents[1]
GROUPS = ("plans", "fronts", "hard", "modes", "robust", "moves", "floors", "searches", "population")
BEFORE = "2dd0121"
"""The last commit before all rows were solved together."""


def main() -> None:
    """Compare two versions, or be one of them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--old", default=BEFORE, help="commit of the old version")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--only", nargs="*", default=list(GROUPS))
    parser.add_argument("--seeds", type=int, default=40, help="of the new version, for starts")
    parser.add_argument("--old-seeds", type=int, default=4)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        serve(options.seeds)
        return
    with tempfile.TemporaryDirectory() as folder:
        unpack(options.old, Path(folder))
        versions = [Version(Path(folder), options.old_seeds), Version(ROOT, options.seeds)]
        for group in options.only:
            once = group in ("modes", "robust", "moves", "starts")
            compare(group, versions, 1 if once else options.repetitions)


def unpack(commit: str, folder: Path) -> None:
    """The files of a commit."""
    archive = subprocess.run(
        ["git", "archive", commit], cwd=ROOT, stdout=subprocess.PIPE, check=True
    ).stdout
    with tarfile.open(fileobj=BytesIO(archive)) as tar:
        tar.extractall(folder, filter="data")


class Version:
    """A process that runs one version."""

    def __init__(self, folder: Path, seeds: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-W", "ignore", __file__, "--serve", "--seeds", str(seeds)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder,
            env={"PYTHONPATH": str(folder), "PATH": "/usr/bin:/bin"},
        )  # fmt: skip

    def __call__(self, group: str, name: str) -> dict:
        """Do one piece of work there."""
        self.process.stdin.write(json.dumps([group, name]) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())


def compare(group: str, versions: list[Version], repetitions: int) -> None:
    """Print a table for a group of work."""
    print(f"\n| {group} | old [s] | new [s] | old / new | energy | |")
    print("|---|---|---|---|---|---|")
    ratios = []
    for name in versions[1](group, ""):
        runs = [[version(group, name) for version in versions] for _ in range(repetitions)]
        old, new = (median(run[i]["seconds"] for run in runs) for i in range(2))
        before, after = (run["energy"] for run in runs[-1])
        count_hits(runs[-1])
        notes = " / ".join(run["note"] for run in runs[-1])
        ratio = change = "-"  # where one of them found nothing
        if before and after:
            ratios.append(median(run[0]["seconds"] / run[1]["seconds"] for run in runs))
            ratio, change = f"{ratios[-1]:.1f}", f"{after / before - 1:+.1e}"
        print(f"| {name} | {old:.3f} | {new:.3f} | {ratio} | {change} | {notes} |", flush=True)
    print(f"| median | | | {median(ratios):.1f} | least {min(ratios):.1f} | |")


def count_hits(both: list[dict]) -> None:
    """Where many seeds were tried: how many found the best that either version found."""
    best = min((energy for run in both for energy in run.get("seeds", [])), default=None)
    for run in both:
        if "seeds" in run:
            hits = sum(energy <= best * (1 + 1e-4) for energy in run["seeds"])
            run["note"] = f"{hits} of {run['tried']}"


# -- in the process of one version --


def serve(seeds: int) -> None:
    """Answer a line with a line, until there are no more."""
    work = {"plans": plans(), "fronts": fronts(), "hard": hard(), "modes": modes()}
    work |= {"floors": floors(), "searches": searches(), "population": population()}
    work |= {"starts": starts(seeds), "robust": robust(), "moves": moves()}
    for line in sys.stdin:
        group, name = json.loads(line)
        answer = list(work[group]) if not name else work[group][name]()
        print(json.dumps(answer), flush=True)


def conditions() -> dict:
    """The paper's six, in its boxes, and four of our own, by name: task and bound."""
    from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
    from quietarm.ocp import PointToPoint

    link, arm = SingleLinkManipulator(), ArmOnFlexibleLink()
    return {
        "link, 0 to pi/6, 0.8 s": (PointToPoint(link, pi / 6, 0.8), 0.2),
        "link, 0 to pi/2, 1.0 s": (PointToPoint(link, pi / 2, 1.0), 0.2),
        "link, 0 to pi/2, 1.1 s": (PointToPoint(link, pi / 2, 1.1), 0.2),
        "arm, 0 to pi/2, 0.8 s": (PointToPoint(arm, pi / 2, 0.8), 0.5),
        "arm, -pi/2 to pi/4, 1.0 s": (PointToPoint(arm, pi / 4, 1.0, -pi / 2), 0.5),
        "arm, -pi/2 to pi/2, 1.2 s": (PointToPoint(arm, pi / 2, 1.2, -pi / 2), 0.5),
        "link, 0 to pi/4, 0.9 s, no box": (PointToPoint(link, pi / 4, 0.9), None),
        "link, 0 to 1, 1.0 s, no box": (PointToPoint(link, 1.0, 1.0), None),
        "arm, 0 to pi/2, 0.8 s, no box": (PointToPoint(arm, pi / 2, 0.8), None),
        "arm, 0 to 1, 0.7 s, 0.5 N m": (PointToPoint(arm, 1.0, 0.7, torque_limit=0.5), 0.5),
    }


def plan(task, terms: int, first: bool = False, **settings) -> dict:
    """Time the second plan of a shape, or the first, and say what it found."""
    from quietarm.ocp import CycloidPolynomial, QuietarmError, plan_move

    began = time.process_time()
    try:
        profile = CycloidPolynomial(terms)
        if not first:
            plan_move(task, profile, starts=1, **settings)
            began = time.process_time()
        found = plan_move(task, profile, starts=1, **settings)
    except (QuietarmError, ValueError) as error:
        note = " ".join(str(error).split()[:8])
        return {"seconds": time.process_time() - began, "energy": None, "note": note}
    note = f"{found.residual:.0e} m"
    return {"seconds": time.process_time() - began, "energy": found.energy, "note": note}


def plans() -> dict:
    """One plan for each condition."""
    return {
        name: lambda task=task, bound=bound: plan(task, 6, bound=bound)
        for name, (task, bound) in conditions().items()
    }


def fronts() -> dict:
    """One front for each condition."""
    from quietarm.ocp import epsilon_front

    def front(task, bound) -> dict:
        began = time.process_time()
        found = epsilon_front(task, bound=bound)
        seconds = time.process_time() - began
        iterations = getattr(found, "iterations", found.evaluations)  # once one number
        return {
            "seconds": seconds,
            "energy": found.energies.mean(),
            "note": f"{len(found.points)} points, {iterations} iterations",
        }

    return {
        name: lambda task=task, bound=bound: front(task, bound)
        for name, (task, bound) in conditions().items()
    }


def hard() -> dict:
    """What was slow before."""
    from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
    from quietarm.ocp import PointToPoint

    arm = PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8)
    link = PointToPoint(SingleLinkManipulator(), pi / 2, 1.0)
    limited = PointToPoint(
        SingleLinkManipulator(), pi / 6, 0.8,
        torque_limit=0.13, speed_limit=1.4, acceleration_limit=20.0, deflection_limit=0.06,
    )  # fmt: skip
    two = PointToPoint(links(2), pi / 2, 0.9)
    return {
        "arm, 20 terms, box 0.5": lambda: plan(arm, 20, bound=0.5),
        "arm, 20 terms, no box": lambda: plan(arm, 20),
        "link, 20 terms, box 0.2": lambda: plan(link, 20, bound=0.2),
        "link, all limits": lambda: plan(limited, 6),
        "link, all limits, 1 mm": lambda: plan(limited, 6, residual_limit=1e-3),
        "two modes, 6 terms": lambda: plan(two, 6),
        "two modes, 10 terms, box 0.5": lambda: plan(two, 10, bound=0.5),
    }


def modes() -> dict:
    """Plants of many modes."""
    from quietarm.ocp import PointToPoint

    return {
        f"{count} modes": lambda count=count: plan(
            PointToPoint(links(count), pi / 2, 1.0), 2 * count + 4, first=True
        )
        for count in (1, 2, 4, 6, 8, 10, 12)
    }


def robust() -> dict:
    """Random machines whose frequency is uncertain."""
    import numpy as np
    from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
    from quietarm.ocp import (
        CycloidPolynomial,
        PointToPoint,
        QuietarmError,
        Uncertainty,
        plan_move,
    )
    from quietarm.ocp import evaluate_coefficients as evaluate

    plants = (
        lambda omega: SingleLinkManipulator(omega=omega),
        lambda omega: ArmOnFlexibleLink(omega=omega),
        lambda omega: DualLinkManipulator(omega1=omega, omega2=0.845 * omega),
    )
    random, found = np.random.default_rng(2026), {}

    def machine(plant, error, target, duration, shares) -> dict:
        plain = evaluate(
            PointToPoint(plant, target, duration), np.zeros(6), profile=CycloidPolynomial(6)
        ).motion
        limits = {}
        if shares is not None:
            limits["acceleration_limit"] = shares[0] * plain.peak_acceleration
            limits["torque_limit"] = shares[1] * plain.peak_torque
        uncertain = Uncertainty({"frequency": error})
        task, most = (
            PointToPoint(plant, target, duration, **limits, uncertainty=uncertain),
            0.05 * plain.peak_deflection,
        )
        began = time.process_time()
        try:
            plan = plan_move(task, residual_limit=most)
        except QuietarmError as error_:
            seconds, words = time.process_time() - began, " ".join(str(error_).split()[:8])
            return {"seconds": seconds, "energy": None, "note": words}
        note = f"{plan.worst.residual / most:.3f} of the limit"
        return {"seconds": time.process_time() - began, "energy": plan.energy, "note": note}

    for i in range(60):
        hertz, duration = random.uniform(1.5, 4.5), random.uniform(0.55, 1.0)
        error, degrees = random.uniform(0.05, 0.10), random.uniform(25, 100)
        limited, shares = random.random() < 0.5, random.uniform(2.5, 5, 2)
        given = error, np.radians(degrees), duration, shares if limited else None
        plant = plants[i % 3](2 * pi * hertz)
        name = f"{plant.name}, {hertz:.2f} Hz, {degrees:.0f} deg in {duration:.2f} s"
        found[name] = lambda plant=plant, given=given: machine(plant, *given)
    return found


def moves() -> dict:
    """Many moves of one plant."""
    import numpy as np
    from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
    from quietarm.ocp import PointToPoint, plan_move

    from quietarm import ocp

    def many(plant) -> dict:
        random = np.random.default_rng(1)
        given = zip(random.uniform(0.4, 1.5, 400), random.uniform(0.8, 1.2, 400), strict=True)
        tasks = [PointToPoint(plant, target, duration) for target, duration in given]
        plan_move(tasks[0])  # the functions are built
        began = time.process_time()
        if hasattr(ocp, "plan_moves"):
            found = ocp.plan_moves(tasks)
            seconds, energies = time.process_time() - began, found.energy[::10]
            note = f"{np.isfinite(found.energy).sum()} solved"
        else:
            energies = np.array([plan_move(task, starts=1).energy for task in tasks[::10]])
            seconds, note = 10 * (time.process_time() - began), "40 solved"
        return {"seconds": seconds, "energy": float(energies.mean()), "note": note}

    plants = SingleLinkManipulator(), ArmOnFlexibleLink(), DualLinkManipulator()
    return {plant.name: lambda plant=plant: many(plant) for plant in plants}


def floors() -> dict:
    """Floors of five conditions, both kinds."""
    from quietarm.ocp import energy_floor

    def floor(task, smooth: bool) -> dict:
        began = time.process_time()
        found = energy_floor(task, smooth=smooth)
        note = f"{len(found.levels)} grids"
        return {"seconds": time.process_time() - began, "energy": found.energy, "note": note}

    paper = {name: task for name, (task, _) in list(conditions().items())[:6]}
    return {
        f"{name}{', smooth' * smooth}": lambda task=task, smooth=smooth: floor(task, smooth)
        for name, task in paper.items()
        if name.startswith(("link, 0 to pi/6", "link, 0 to pi/2, 1.0", "arm"))
        for smooth in (False, True)
    }


def searches() -> dict:
    """The paper's two searches on its six conditions, in its boxes."""
    from quietarm.metaheuristics import search

    def front(task, bound: float, method: str) -> dict:
        began = time.process_time()
        found = search(task, method, bound=bound, generations=60)
        seconds = time.process_time() - began
        note = f"{len(found.points)} points"
        return {"seconds": seconds, "energy": found.energies.min(), "note": note}

    return {
        f"{name}, {method}": (
            lambda task=task, bound=bound, method=method: front(task, bound, method)
        )
        for name, (task, bound) in list(conditions().items())[:6]
        for method in ("nsga2", "vepso")
    }


def population() -> dict:
    """The objective of many candidates."""
    import numpy as np
    from quietarm.metaheuristics import PopulationObjective
    from quietarm.ocp import CycloidPolynomial

    def calls(task, bound: float) -> dict:
        objective = PopulationObjective(task, CycloidPolynomial(6))
        candidates = np.random.default_rng(0).uniform(-bound, bound, (200, 6))
        energy = objective(candidates).energy.mean()
        began = time.process_time()
        for _ in range(100):
            objective(candidates)
        return {"seconds": time.process_time() - began, "energy": energy, "note": ""}

    return {
        name: lambda task=task, bound=bound: calls(task, bound)
        for name, (task, bound) in list(conditions().items())[:6]
    }


def starts(seeds: int) -> dict:
    """Many seeds of a plan, for each move, number of terms, and box."""
    from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
    from quietarm.ocp import PointToPoint

    link, arm = SingleLinkManipulator(), ArmOnFlexibleLink()
    others = {
        "link, 0 to pi/4, 0.9 s": PointToPoint(link, pi / 4, 0.9),
        "link, 0 to 1, 1.0 s": PointToPoint(link, 1.0, 1.0),
        "link, 0 to pi, 1.5 s": PointToPoint(link, pi, 1.5),
        "link, 0 to pi/3, 0.7 s": PointToPoint(link, pi / 3, 0.7),
        "link, -pi/4 to pi/4, 1.3 s": PointToPoint(link, pi / 4, 1.3, -pi / 4),
        "arm, 0 to 1, 0.7 s": PointToPoint(arm, 1.0, 0.7),
        "arm, 0 to pi/2, 1.1 s": PointToPoint(arm, pi / 2, 1.1),
        "arm, 0 to pi, 1.5 s": PointToPoint(arm, pi, 1.5),
        "arm, -pi/2 to 0, 0.9 s": PointToPoint(arm, 0.0, 0.9, -pi / 2),
        "arm, 0 to pi/3, 0.6 s": PointToPoint(arm, pi / 3, 0.6),
    }
    paper = {name: task for name, (task, _) in list(conditions().items())[:6]}
    return {
        f"{name}, {terms} terms, {f'box {bound}' if bound else 'no box'}": (
            lambda task=task, terms=terms, bound=bound: many_seeds(task, terms, bound, seeds)
        )
        for name, task in {**paper, **others}.items()
        for terms in (6, 10)
        for bound in (0.2 if task.plant == link else 0.5, None)
    }


def many_seeds(task, terms: int, bound: float | None, seeds: int) -> dict:
    """Plan with every seed; say how many found the best, and how many found none."""
    from quietarm.ocp import CycloidPolynomial, QuietarmError, plan_move

    began, energies = time.process_time(), []
    for seed in range(seeds):
        try:
            found = plan_move(task, CycloidPolynomial(terms), bound=bound, seed=seed)
        except QuietarmError:
            continue
        energies.append(found.energy)
    seconds = (time.process_time() - began) / seeds
    best = min(energies, default=None)
    return {"seconds": seconds, "energy": best, "seeds": energies, "tried": seeds, "note": ""}


def links(count: int):
    """Flexible links on one hub, invented; 8, 15, 22, ... rad/s: told apart within 1 s."""
    import numpy as np
    from quietarm.models import Plant, parameter

    frequencies = (8.0 + 7.0 * np.arange(count)).tolist()

    @dataclass(frozen=True)
    class Links(Plant):
        name: ClassVar[str] = f"links-{count}"
        modes: ClassVar[int] = count

        inertia: float = parameter(0.03, "kg m^2", "invented")
        c: float = parameter(0.03, "N m s", "invented")

        def modal_accelerations(self, joint, W, dW):
            return [
                -0.02 * omega * dW[i]
                - (omega**2 + 0.01 * joint.speed**2) * W[i]
                - 0.25 * joint.acceleration / (1 + i)
                for i, omega in enumerate(frequencies)
            ]

        def torque(self, joint, W, dW, ddW):
            of_links = sum(0.05 / (1 + i) * ddW[i] for i in range(count))
            return self.inertia * joint.acceleration + self.c * joint.speed + of_links

        def tip_displacements(self, W):
            return [sum(2 * (-1) ** i * W[i] for i in range(count))]

    return Links()


if __name__ == "__main__":
    main()
