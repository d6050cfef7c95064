"""Interrupt operations by Ctrl-C at random instants, and see if the next call works.

    python benchmarks/interrupts.py [--presses 1500] [--only path plan ...] [--seed 1]

Every operation is pressed as often. The first group runs in this process, over and over until the
press comes, at a random instant of its first two runs. Right: it ends in KeyboardInterrupt,
Python's own handler stands again, no tracer is left, and the next call gives what it gave before;
the longest wait from a press to the end stands beside it. The second
group, `fresh`, begins with a process that has imported nothing: what is pressed there is mostly an
import. The third are commands, pressed between their start and their end. Right: the last word is
'interrupted', the status 130, or all was done before the press. A press that comes before Python
has begun to read quietarm is not ours, and is counted as `before quietarm`.
"""

from __future__ import annotations

import argparse
import os
import random
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

import quietarm as qa

MOVE = "single-link --target 30deg --duration 0.8"
PROMPT_SECONDS = 5.0
"""An operation that goes on for longer after the press has lost it."""


def operations(folder: Path) -> dict[str, Callable[[], Any]]:
    """Return what is pressed in this process: each gives a number that the next must give again."""
    from matplotlib import pyplot

    task = qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8)
    limited = qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, torque_limit=0.5)
    copper = qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, energy=qa.CopperLoss(0.12))
    two = qa.CycloidPolynomial(2)
    plan = qa.plan_move(task, two)
    front = qa.epsilon_front(task, two, points=3)
    times = np.linspace(0, 0.8, 20_000)
    file = folder / "front.json"

    def drawn() -> int:
        figure = qa.motion_figure(plan)
        pyplot.close(figure)
        return len(figure.axes)

    def kept() -> float:
        front.save(file)
        return qa.Front.load(file).points[0].energy

    def swept() -> float:
        with tempfile.TemporaryDirectory() as place:
            axes = {"target": [0.3, 0.6]}
            grid = qa.sweep(task, two, axes=axes, path=Path(place) / "few.zarr")
            return float(grid["energy"].sum())

    return {
        "path": lambda: plan.path(times).sum(),
        "evaluate": lambda: qa.evaluate_coefficients(task, [0.01, -0.1]).energy,
        "plan": lambda: qa.plan_move(limited, two).energy,
        "plan-ipopt": lambda: qa.plan_move(limited, two, solver=qa.Ipopt()).energy,
        "front": lambda: qa.epsilon_front(task, two, points=3).points[0].energy,
        "floor": lambda: qa.energy_floor(copper).energy,
        "search": lambda: (
            qa.search(task, two, algorithm="nsga2", bound=0.2, population=12, generations=5, seed=1)
            .points[0]
            .energy
        ),
        "sweep": swept,
        "figure": drawn,
        "save-load": kept,
        "robustness": lambda: qa.evaluate_robustness(plan.candidate, {"omega": 0.1}).cycloid,
    }


FRESH = """
import random, signal, sys, threading, time, os
import quietarm as qa
signal.signal(signal.SIGINT, signal.default_int_handler)
{prepare}
def work():
    {work}
threading.Timer({instant}, os.kill, (os.getpid(), signal.SIGINT)).start()
ended = "done before the press"
try:
    work()
    time.sleep(0.01)
except KeyboardInterrupt:
    ended = "KeyboardInterrupt"
except Exception as error:
    ended = type(error).__name__
    print(error)
try:
    while ended == "done before the press":
        time.sleep(1)
except KeyboardInterrupt:
    pass
if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
    ended += ", handler left"
try:
    work()
except Exception as error:
    ended += ", then " + type(error).__name__
print("ending:", ended)
"""
FRESH_WORK = {
    "fresh plan": ("", "qa.plan_move(qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8))", 2.0),
    "fresh figure": (
        "plan = qa.evaluate_coefficients("
        "qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8), [0.01])",
        "qa.motion_figure(plan)",
        1.0,
    ),
}
COMMANDS = {
    "plan command": f"plan {MOVE} --output p.json --output p.png",
    "search command": f"search {MOVE} --bound 0.2 --terms 2 --generations 30 --output s.json",
    "compare command": "compare ../plan.json --output compared",
    "sweep command": f"sweep {MOVE.replace('30deg', '20deg,30deg')} --terms 2 --output s.zarr",
}


def press_here(work: Callable[[], Any], instant: float, right: Any) -> tuple[str, float]:
    """Return how an operation ends that is pressed after so many seconds, and how long it takes."""
    pressed: list[float] = []

    def press() -> None:
        time.sleep(instant)
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press)
    ending = "lost"
    try:
        thread.start()
        while not pressed or time.monotonic() < pressed[0] + PROMPT_SECONDS:
            work()
    except KeyboardInterrupt:
        ending = "KeyboardInterrupt"
    except Exception as error:
        ending = f"{type(error).__name__}: {error}"
    thread.join()
    waited = time.monotonic() - pressed[0]
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        ending += ", handler left"
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if sys.gettrace() is not None:
        ending += ", tracer left"
        sys.settrace(None)
    try:
        if work() != right:
            ending += ", then another answer"
    except Exception as error:
        ending += f", then {type(error).__name__}"
    return ending, waited


def press_fresh(name: str, instant: float) -> str:
    """Return how an operation ends in a process of its own."""
    prepare, work, _ = FRESH_WORK[name]
    script = FRESH.format(prepare=prepare, work=work, instant=instant)
    ran = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=300
    )
    endings = [line for line in ran.stdout.splitlines() if line.startswith("ending:")]
    words = endings[-1].removeprefix("ending: ") if endings else ran.stderr[-200:]
    return words if not ran.stderr else f"{words}, {ran.stderr[-200:]}"


def press_command(line: str, folder: Path, instant: float) -> str:
    """Return how a command ends that is pressed after so many seconds."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        command = [sys.executable, "-m", "quietarm", *shlex.split(line)]
        process = subprocess.Popen(
            command, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        time.sleep(instant)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=300)
    last = err.strip().splitlines()[-1:] or [""]
    if process.returncode == 0:
        return "done before the press"
    if process.returncode == 130 and last[0].startswith("quietarm: interrupted"):
        return "traceback" if "Traceback" in err else "interrupted, 130"
    if last[0] in ("", "KeyboardInterrupt") and "as_command" not in err:
        return "before quietarm"
    return f"{process.returncode}: {last[0]}"


def seconds_of(work: Callable[[], Any]) -> float:
    """Return how long work takes [s]."""
    begun = time.monotonic()
    work()
    return time.monotonic() - begun


def measure(presses: int, only: list[str], seed: int) -> None:
    """Press, and print how each operation ended."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        qa.evaluate_coefficients(
            qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8), [0.01]
        ).save(folder / "plan.json")
        here = operations(folder)
        names = [one for one in (*here, *FRESH_WORK, *COMMANDS) if not only or one in only]
        whole = Counter[str]()
        for name in names:
            endings = Counter[str]()
            slowest = 0.0
            if name in here:
                work = here[name]
                right = work()
                longest = max(2 * seconds_of(work), 0.05)
            elif name in COMMANDS:
                longest = 1.1 * seconds_of(lambda line=COMMANDS[name]: _run(line, folder))
            else:
                longest = FRESH_WORK[name][2]
            for _ in range(-(-presses // len(names))):
                instant = longest * rng.random()
                if name in here:
                    ending, waited = press_here(work, instant, right)
                    endings[ending] += 1
                    slowest = max(slowest, waited)
                elif name in COMMANDS:
                    endings[press_command(COMMANDS[name], folder, instant)] += 1
                else:
                    endings[press_fresh(name, instant)] += 1
            whole += endings
            after = f", at most {slowest:.2f} s after the press" if slowest else ""
            print(f"{name:16} {dict(endings)}{after}", flush=True)
        print(f"{'all':16} {dict(whole)}")


def _run(line: str, folder: Path) -> None:
    with tempfile.TemporaryDirectory(dir=folder) as place:
        command = [sys.executable, "-m", "quietarm", *shlex.split(line)]
        subprocess.run(command, cwd=place, capture_output=True, check=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--presses", type=int, default=1500)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    measure(given.presses, given.only, given.seed)
