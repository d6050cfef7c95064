"""Robust plans and robust fastest moves: processor time, solves, answers, and what is left.

    python benchmarks/robust_plans.py [--against ../before] [--only "link, limits" ...] [--list]

Each task is a command of `quietarm plan` in an interpreter of its own. With another checkout both
take turns, task by task, so that other load on the machine affects both alike; ratios are this
checkout over that one, below 1 is faster or cheaper. Times are the processor's, without imports.

- solves: problems given to a solver, each start one; iterations: of all of them;
- built: processor time of building functions, a part of the time;
- left / limit: the largest residual that CVODES finds over 60 errors drawn in the ranges and their
  corners, none of which the planner has seen but the corners, over the plan's residual limit;
- beyond: by how much the motion passes the limits on its way, by CVODES.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from statistics import geometric_mean
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).resolve().parents[1]
BEAM = "flexible-beam --set omega=3.2Hz --set zeta=0.01 --target 60deg"
GANTRY = (
    "linear-axis --set omega1=4.498Hz --set zeta1=0.007 --set mass=82.7kg --set load=15kg"
    " --set friction=50 --target 0.8 --speed-limit 1.5 --acceleration-limit 7 --jerk-limit 150"
    " --torque-limit 780"
)
UR5 = "--start=0,-1.4,1.7,-1.87,-1.57,0"
TASKS: Mapping[str, str] = {
    "link": "single-link --target 30deg --duration 0.8 --error frequency=10%",
    "link, 5 % and 4 mm": "single-link --target 30deg --duration 0.8 --error frequency=5%"
    " --residual-limit 4mm",
    "link, two errors": "single-link --target 90deg --duration 1.0 --error frequency=5%"
    " --error damping=30% --residual-limit 8mm",
    "link, limits": "single-link --target 30deg --duration 0.8 --error frequency=10%"
    " --torque-limit 0.2 --jerk-limit 400",
    "link, gaussians": "single-link --target 30deg --duration 0.8 --error frequency=5%"
    " --profile gaussians",
    "arm": "arm-on-flexible-link --start=-90deg --target 90deg --duration 1.2"
    " --error frequency=5% --residual-limit 5mm",
    "arm, limits": "arm-on-flexible-link --target 90deg --duration 1.0 --error frequency=7%"
    " --torque-limit 0.3 --jerk-limit 1500",
    "dual link": "dual-link --target 90deg --duration 1.4 --error frequency=5%",
    "dual link, limits": "dual-link --target 60deg --duration 1.2 --error frequency=3%"
    " --torque-limit 0.5 --jerk-limit 1000",
    "beam, 6 terms": f"{BEAM} --duration 0.7 --terms 6 --torque-limit 1.5"
    " --acceleration-limit 80 --error frequency=8%",
    "beam, limits": f"{BEAM} --duration 0.7 --torque-limit 1.5 --acceleration-limit 80"
    " --jerk-limit 3000 --error frequency=8%",
    "beam, band": f"{BEAM} --duration 0.8 --torque-limit 1.5 --jerk-limit 3000"
    " --error frequency=5% --residual-limit 0.1mm",
    "link, band": "single-link --target 30deg --duration 0.8 --band 0.1mm",
    "dual link, band": "dual-link --target 60deg --duration 1.6 --band 0.1mm",
    "gantry, band": f"{GANTRY} --duration 0.906 --band 0.1mm",
    "elastic joints": f"elastic.yaml {UR5} --target=1.4,-1.0,1.2,-1.3,-1.2,0.6 --duration 1.0"
    " --terms 8 --error stiffness=10%",
    "robot with a bar": f"bar.yaml {UR5} --target=1.4,-1.0,1.2,-1.3,-1.2,0.6 --duration 1.2"
    " --terms 8 --set payload=1 --error payload=10%",
    "fastest, link": "single-link --target 25deg --duration fastest --torque-limit 0.13"
    " --error frequency=7%",
    "fastest, link, jerk": "single-link --target 30deg --duration fastest --torque-limit 0.2"
    " --jerk-limit 400 --error frequency=5%",
    "fastest, link, two errors": "single-link --target 30deg --duration fastest"
    " --torque-limit 0.2 --jerk-limit 400 --error frequency=3% --error damping=20%",
    "fastest, arm": "arm-on-flexible-link --target 90deg --duration fastest"
    " --torque-limit 0.3 --jerk-limit 1500 --error frequency=5%",
    "fastest, dual link": "dual-link --target 60deg --duration fastest --torque-limit 0.5"
    " --jerk-limit 1000 --error frequency=3%",
    "fastest, beam": f"{BEAM} --duration fastest --torque-limit 1.5 --acceleration-limit 80"
    " --error frequency=8%",
    "fastest, beam, band": f"{BEAM} --duration fastest --torque-limit 1.5 --jerk-limit 3000"
    " --error frequency=5% --residual-limit 0.1mm",
    "fastest, 8 terms": "single-link --target 30deg --duration fastest --terms 8"
    " --torque-limit 0.2 --jerk-limit 400 --error frequency=5%",
    "refused, gantry, band": f"{GANTRY} --duration 0.81 --band 0.1mm",
    "refused, link, band": "single-link --target 30deg --duration 0.5 --band 0.1mm"
    " --torque-limit 0.2 --jerk-limit 400",
    "refused, rigid": "single-link --target 30deg --duration 0.3 --band 0.1mm"
    " --torque-limit 0.2 --jerk-limit 400",
}
"""Words of `quietarm plan` by name; what is refused counts by its time alone."""
URDF = HERE / "tests" / "fixtures" / "ur5_robot.urdf"
ROBOTS = {
    "elastic.yaml": """urdf: ur5.urdf
elastic_joints:
  shoulder_pan_joint: {stiffness: 6kNm/rad, damping: 10}
  elbow_joint: {stiffness: 4kNm/rad, damping: 5}
rotor_inertia: {shoulder_pan_joint: 0.5, elbow_joint: 0.3}
tip: wrist_3_link
modes: 2
""",
    "bar.yaml": """urdf: ur5.urdf
beam: {at: tool0, length: 0.8, width: 8mm, height: 12mm,
  youngs_modulus: 70GPa, density: 2700, tip_mass: 500g, damping: 0.5%}
""",
}
"""The robots of two tasks: gears that give, and an aluminium bar in the flange."""


def main() -> None:
    """Compare two checkouts, or do one task."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--against", type=Path, help="folder of another checkout")
    parser.add_argument("--only", nargs="*", choices=TASKS, default=list(TASKS), metavar="TASK")
    parser.add_argument("--list", action="store_true", help="print the commands")
    parser.add_argument("--work", choices=TASKS, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        print(json.dumps(work(options.work)))
    elif options.list:
        for name, words in TASKS.items():
            print(f"{name}: quietarm plan {words}")
    else:
        folders = [HERE] if options.against is None else [options.against.resolve(), HERE]
        compare(folders, options.only)


def compare(folders: Sequence[Path], names: Sequence[str]) -> None:
    """Print a row for each task."""
    columns = ["time [s]", "built [s]", "solves", "iterations", "duration [s]", "energy [J]"]
    columns += ["left / limit", "beyond"]
    print(f"| task | {' | '.join(columns)} |")
    print("|---" * (len(columns) + 1) + "|")
    ratios: dict[str, list[float]] = {"time": [], "duration": [], "energy": []}
    for name in names:
        answers = [ask(folder, name) for folder in folders]
        cells = [" / ".join(entry) for entry in zip(*map(_cells, answers), strict=True)]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
        if len(answers) < 2:
            continue
        before, now = answers
        for figure, known in ratios.items():
            if figure in before and figure in now:
                known.append(now[figure] / before[figure])
    for figure, known in ratios.items():
        if known:
            spread = f"{min(known):.4g} to {max(known):.4g}"
            print(f"{figure}: now / before {geometric_mean(known):.4g} on average, {spread}")


def _cells(answer: Mapping[str, Any]) -> list[str]:
    """The figures of an answer in words."""
    if "failed" in answer:
        return [f"{answer['time']:.2f}", "", "", "", answer["failed"], "", "", ""]
    return [
        f"{answer['time']:.2f}",
        f"{answer['built']:.2f}",
        f"{answer['solves']}",
        f"{answer['iterations']}",
        f"{answer['duration']:.5g}",
        f"{answer['energy']:.6g}",
        f"{answer['left']:.4f}",
        f"{answer['beyond']:.1e}",
    ]


def ask(folder: Path, name: str) -> dict[str, Any]:
    """Do a task with the package of a folder, in an interpreter of its own."""
    environment = os.environ | {"PYTHONPATH": str(folder)}
    command = [sys.executable, str(Path(__file__).resolve()), "--work", name]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{name} with {folder} ended with {done.returncode}: {done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def work(name: str) -> dict[str, Any]:
    """The figures of a task, and how long it took [s of processor time]."""
    import quietarm as qa
    from quietarm.studies.cli.application import main as command

    with TemporaryDirectory() as folder, counted_solves() as counts:
        for file, text in ROBOTS.items():
            (Path(folder) / file).write_text(text)
        (Path(folder) / "ur5.urdf").write_bytes(URDF.read_bytes())
        os.chdir(folder)
        began = sum(os.times()[:2])
        try:
            command(["plan", *TASKS[name].split(), "--quiet", "--output", "plan.json"])
        except SystemExit as end:
            status = end.code
        seconds = sum(os.times()[:2]) - began
        if status:
            return {"failed": f"status {status}", "time": seconds}
        plan = qa.Plan.load("plan.json")
        os.chdir(HERE)
    return {
        "time": seconds,
        **counts,
        "duration": plan.task.duration,
        "energy": plan.energy,
        "left": left(plan) / plan.residual_limit,
        "beyond": beyond(plan),
    }


@contextmanager
def counted_solves() -> Iterator[dict[str, float]]:
    """Count solves and iterations of both solvers, and the time of builds, in the block."""
    from quietarm.ocp import Ipopt, Sqp
    from quietarm.ocp.cost import COST

    counts: dict[str, float] = {"solves": 0, "iterations": 0}
    known = {kind: kind.solve for kind in (Sqp, Ipopt)}

    def counting(solve: Any) -> Any:
        def counted(self: Any, problems: Any, *rest: Any, **options: Any) -> Any:
            solutions = solve(self, problems, *rest, **options)
            counts["solves"] += len(problems)
            counts["iterations"] += sum(solution.iterations for solution in solutions)
            return solutions

        return counted

    before = COST.copy()
    for kind, solve in known.items():
        kind.solve = counting(solve)
    try:
        yield counts
    finally:
        for kind, solve in known.items():
            kind.solve = solve
        counts["built"] = COST.since(before).builds


def left(plan: Any, drawn: int = 60) -> float:
    """The largest residual [m] within the ranges that CVODES finds."""
    import numpy as np

    ranges = plan.task.ranges
    largest = np.array(list(ranges.values()))
    random = np.random.default_rng(1).uniform(-1.0, 1.0, (drawn, len(largest)))
    corners = np.array(list(product((-1.0, 1.0), repeat=len(largest))))
    errors = np.concatenate([corners, random]) * largest
    motions = (plan.candidate.perturbed(dict(zip(ranges, row, strict=True))) for row in errors)
    return max(motion.residual for motion in motions)


def beyond(plan: Any) -> float:
    """The largest share by which the motion passes a limit on its way."""
    exceeded = plan.figures.exceeded(plan.task.limits)
    return max(exceeded.values(), default=1.0) - 1


if __name__ == "__main__":
    main()
