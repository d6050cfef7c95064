"""Grids of moves: speed against a loop of plans, memory, workers, and what kills leave.

    python benchmarks/sweeps.py [speed] [workers] [memory] [killed]

- speed: a chunk in the middle of grids of each plant, 10 to 90 deg in 0.6 to 1.4 s, six terms, with
  and without its check by cold starts; against `plan_move` with its defaults for every twelfth of
  these moves. Processor times, functions built before.
- workers: 3,609 moves by one worker and by two, wall time.
- memory: peak of a process that sweeps 100,000 cells with two terms, as it goes on.
- killed: 2,061 moves by two workers, one of them killed with SIGKILL, and after the same line the
  client; the same line again, and two parts at once, against an undisturbed run.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from statistics import median

import numpy as np
import xarray as xr

from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, plan_move, plan_moves
from quietarm.studies.sweep.definition import Definition, PlanSettings
from quietarm.studies.sweep.grid_cells import plan_chunk
from quietarm.studies.sweep.move_grid import Axis, MoveGrid

QUIETARM = str(Path(sys.executable).parent / "quietarm")


def speed() -> None:
    """Processor time of a move, in a grid and by itself."""
    repetitions = 4  # of which the first builds functions
    for plant in (SingleLinkManipulator(), ArmOnFlexibleLink(), DualLinkManipulator()):
        for steps in (16, 80):
            targets = np.radians(np.linspace(10, 90, steps + 1)).tolist()
            durations = np.linspace(0.6, 1.4, steps + 1).tolist()
            axes = Axis("target", tuple(targets), "rad"), Axis("duration", tuple(durations), "s")
            grid = MoveGrid(PointToPoint(plant, 1.0, 1.0), axes)
            sweep = Definition(grid, CycloidPolynomial(), PlanSettings())
            middle = len(sweep.chunks) // 2
            tasks = sweep.grid.tasks(sweep.chunks[middle])
            in_grid, unchecked, alone = list[float](), list[float](), list[float]()
            for _ in range(repetitions):
                marks = [time.process_time()]
                plan_chunk(sweep, middle)
                marks.append(time.process_time())
                plan_moves(tasks)
                marks.append(time.process_time())
                for one in tasks[::12]:
                    plan_move(one)
                marks.append(time.process_time())
                counts = len(tasks), len(tasks), len(tasks[::12])
                spans = zip(pairwise(marks), counts, strict=True)
                took = [(end - begin) / count for (begin, end), count in spans]
                for times, seconds in zip((in_grid, unchecked, alone), took, strict=True):
                    times.append(seconds)
            each, plans, loop = (median(times[1:]) for times in (in_grid, unchecked, alone))
            print(
                f"{plant.name}, {80 / steps:g} deg, {800 / steps:g} ms: {1e3 * each:.1f} ms a "
                f"move, {1 / each:.0f} a second and core; unchecked {1e3 * plans:.1f} ms; "
                f"plan_move {1e3 * loop:.0f} ms, {loop / each:.1f} and {loop / plans:.1f} times",
                flush=True,
            )


def line(folder: Path, name: str, durations: str, *more: str) -> list[str]:
    """The command of a sweep over nine targets of the link."""
    task = f"sweep single-link --target 10deg:90deg:10deg --duration {durations}"
    return [QUIETARM, *task.split(), *more, "--output", str(folder / name)]


def workers(folder: Path) -> None:
    """Wall times of the whole command, functions built and workers started in it."""
    took = dict[int, float]()
    for number in (1, 2):
        began = time.monotonic()
        asked = line(folder, f"by{number}.zarr", "0.6:1.4:0.002", "--workers", str(number))
        subprocess.run(asked, check=True, capture_output=True)
        took[number] = time.monotonic() - began
    print(f"3,609 moves take {took[1]:.1f} s by one worker, {took[2]:.1f} s by two", flush=True)


def memory(folder: Path) -> None:
    """Memory of the process every 30 s."""
    asked = line(folder, "large.zarr", "0.6:1.4:0.00008", "--terms", "2", "--quiet")
    process, began = subprocess.Popen(asked, stdout=subprocess.DEVNULL), time.monotonic()
    while process.poll() is None:
        time.sleep(30)
        try:
            status = Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
        except OSError:
            break
        found = re.search(r"VmRSS:\s+(\d+)", status)
        if found:
            print(f"{time.monotonic() - began:.0f} s: {int(found[1]) / 1e3:.0f} MB", flush=True)
    moves = xr.open_zarr(folder / "large.zarr", consolidated=False)
    print(f"{moves.energy.size} cells, {time.monotonic() - began:.0f} s", flush=True)


def killed(folder: Path) -> None:
    """Show that the dataset is the same, whatever is killed."""

    def asked(name: str, *more: str) -> list[str]:
        return line(folder, name, "0.6:1.4:0.0035087719298245615", "--quiet", *more)

    subprocess.run(asked("whole.zarr"), check=True)
    whole = xr.open_zarr(folder / "whole.zarr", consolidated=False).load()
    print(f"{whole.energy.size} moves", flush=True)
    two = asked("killed.zarr", "--workers", "2")
    process = subprocess.Popen(two, start_new_session=True)
    wait_for_chunks(folder / "killed.zarr", 1, process)
    workers_of = subprocess.run(["pgrep", "-f", "-s", str(process.pid), "loky"],
                                capture_output=True, text=True).stdout.split()  # fmt: skip
    os.kill(int(workers_of[-1]), signal.SIGKILL)  # the command ends, and says so
    print(f"status {process.wait()} after a worker was killed", flush=True)
    process = subprocess.Popen(two, start_new_session=True)
    wait_for_chunks(folder / "killed.zarr", 3, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    subprocess.run(two, check=True)
    parts = [subprocess.Popen(asked("parts.zarr", "--part", f"{k}/2")) for k in (1, 2)]
    for part in parts:
        part.wait()
    for name in ("killed.zarr", "parts.zarr"):
        other = xr.open_zarr(folder / name, consolidated=False).load()
        same = all(np.array_equal(other[v], whole[v], equal_nan=True) for v in whole.data_vars)
        print(f"{name} is {'the same' if same else 'ANOTHER'}", flush=True)


def wait_for_chunks(path: Path, count: int, process: subprocess.Popen[bytes]) -> None:
    """Wait until so many chunks are written, or the process has ended."""
    while process.poll() is None and len([*path.glob("status/c/*/*")]) < count:
        time.sleep(0.05)


if __name__ == "__main__":
    chosen, place = sys.argv[1:] or ["speed", "workers", "killed"], Path(tempfile.mkdtemp())
    try:
        if "speed" in chosen:
            speed()
        for one in (workers, memory, killed):
            if one.__name__ in chosen:
                one(place)
    finally:
        shutil.rmtree(place)
