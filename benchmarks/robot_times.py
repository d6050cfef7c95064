"""Measure where a robot's plan spends processor time, on the UR5 with its bar.

    pip install "quietarm[robot]" example-robot-data
    python benchmarks/robot_times.py [stages] [commands]

`stages` goes through a plan in a process of Python; `commands` are whole commands, as they are
typed. Each is timed with nothing kept, with an empty folder of kept functions, and again.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

STARTS = ("nothing kept", "keeping", "kept")
ROBOT = """urdf: robot.urdf
beam: {at: tool0, length: 0.8, width: 8mm, height: 12mm, youngs_modulus: 70GPa, density: 2700,
  tip_mass: 500g, damping: 0.5%}
"""
JOINT_LIMITS = "joint_limits:\n" + "".join(
    f"  {joint}: {{max_velocity: 3.0, max_acceleration: 14.0, max_jerk: 300.0}}\n"
    for joint in ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")
)
WAYPOINTS = """0.0,-1.40,1.70,-1.87,-1.57,0.0
0.5,-1.35,1.50,-1.70,-1.45,0.2
1.0,-1.20,1.35,-1.50,-1.30,0.4
1.4,-1.00,1.20,-1.30,-1.20,0.6
"""
"""These and the limits are those of docs/robots.md."""
LINE = "--start=0,-1.4,1.7,-1.87,-1.57,0 --target=1.4,-1,1.2,-1.3,-1.2,0.6"
LIMITS = "--torque-limit 150 --speed-limit 3.15 --acceleration-limit 12 --jerk-limit 250"
COMMANDS = {
    "plan, 1 s": f"plan robot.yaml {LINE} --duration 1",
    "plan, 1 s, 8 terms, load 10 % off": (
        f"plan robot.yaml {LINE} --duration 1 --terms 8 --error payload=10%"
    ),
    "plan, 1.2 s, waypoints within limits": (
        "plan limited.yaml --path waypoints.csv --duration 1.2"
    ),
    "plan, 1.2 s, waypoints within limits, load 10 % off": (
        "plan limited.yaml --path waypoints.csv --duration 1.2 --error payload=10%"
    ),
    "plan, fastest, 12 terms, within limits": (
        f"plan robot.yaml {LINE} --duration fastest --terms 12 {LIMITS}"
    ),
    "plan within limits in 0.3 s, refused": f"plan robot.yaml {LINE} --duration 0.3 {LIMITS}",
}


def in_stages() -> None:
    """Print the seconds of each stage of a plan in this process, one a line."""
    begin = time.process_time()

    def lap(stage: str) -> None:
        nonlocal begin
        now = time.process_time()
        print(f"{stage}\t{now - begin:.2f}", flush=True)
        begin = time.process_time()

    import quietarm as qa
    from quietarm.ocp import off_model

    lap("import")
    robot = qa.Robot.load("robot.yaml")
    lap("URDF and equations")
    task = robot.task(qa.GeometricPath.line(*_ends()), 1.0)
    lap("tables of the path, checks")
    plan = qa.plan_move(task)
    lap("functions, solve, certify")
    _ = plan.candidate.in_full
    lap("in full")
    off_model.off_model(plan.candidate)
    lap("if the model is off")
    _ = qa.plan_move(robot.task(task.plant.path, 1.1))
    lap("another duration afterwards")


def _ends() -> list[list[float]]:
    return [[float(x) for x in part.split("=")[1].split(",")] for part in LINE.split()]


def seconds_of(command: list[str], folder: Path, kept: str) -> tuple[float, str]:
    """The processor's seconds of a process, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "QUIETARM_CACHE": kept, "OMP_NUM_THREADS": "1"}
    run = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent, run.stdout


def table(rows: dict[str, list[str]]) -> None:
    """Print rows of three columns."""
    print(f"| processor time [s] | {' | '.join(STARTS)} |\n|---|---:|---:|---:|")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def stages(folder: Path) -> None:
    """The table of stages."""
    rows = dict[str, list[str]]()
    for kept in ("off", str(folder / "stages"), str(folder / "stages")):
        _, printed = seconds_of([sys.executable, __file__, "in-stages"], folder, kept)
        for line in printed.splitlines():
            stage, seconds = line.split("\t")
            rows.setdefault(stage, []).append(seconds)
    table(rows)


def commands(folder: Path) -> None:
    """The table of commands."""
    rows = dict[str, list[str]]()
    for name, command in COMMANDS.items():
        for kept in ("off", str(folder / name), str(folder / name)):
            typed = [sys.executable, "-m", "quietarm", *command.split(), "--output=plan.json"]
            spent, _ = seconds_of(typed, folder, kept)
            rows.setdefault(name, []).append(f"{spent:.1f}")
    table(rows)


def main() -> None:
    """Print what is named, or both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    choices = {"stages": stages, "commands": commands}
    parser.add_argument("what", nargs="*", choices=["all", *choices, "in-stages"], default="all")
    asked = parser.parse_args().what
    if "in-stages" in asked:
        return in_stages()
    from robots import urdf_of

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = urdf_of("ur5_robot.urdf")
        (folder / "robot.urdf").write_text(text if isinstance(text, str) else text.read_text())
        (folder / "robot.yaml").write_text(ROBOT)
        (folder / "limited.yaml").write_text(f"{ROBOT}limits: joint_limits.yaml\n")
        (folder / "joint_limits.yaml").write_text(JOINT_LIMITS)
        (folder / "waypoints.csv").write_text(WAYPOINTS)
        for name in choices if "all" in asked else asked:
            choices[name](folder)
    return None


if __name__ == "__main__":
    main()
