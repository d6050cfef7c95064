"""Processor time of what users wait for, from one version to the next.

Only names that versions 1.0.0 and later share are called, so that one suite times them all.
"""

import subprocess
import sys
from math import pi
from time import process_time

import quietarm as qa

MOVES = {
    "single link": ("SingleLinkManipulator", pi / 6, 0.8),
    "arm on a flexible link": ("ArmOnFlexibleLink", pi / 2, 1.2),
    "dual link": ("DualLinkManipulator", pi / 2, 0.9),
}


def task_of(name):
    """Return the move of this name as a task."""
    plant, target, duration = MOVES[name]
    return qa.PointToPoint(getattr(qa, plant)(), target=target, duration=duration)


class Moves:
    """Plans and fronts when all functions are built."""

    params = tuple(MOVES)
    param_names = ("plant",)
    timer = process_time
    timeout = 300
    rounds, repeat, number = 1, 5, 1

    def setup(self, name):
        """Build all functions, which the timed calls then have."""
        self.task = task_of(name)
        self.profile = qa.CycloidPolynomial(6)
        qa.plan_move(self.task, self.profile)

    def time_plan(self, name):
        """Plan the move with six coefficients."""
        qa.plan_move(self.task, self.profile)

    def time_front(self, name):
        """Trace its front with twenty points."""
        qa.epsilon_front(self.task, self.profile, points=20)

    def track_energy(self, name):
        """Return the energy of the plan [J]: what is faster must not be dearer."""
        return qa.plan_move(self.task, self.profile).energy

    track_energy.unit = "J"


class Processes:
    """Processor time that a new process costs."""

    timer = process_time
    timeout = 300

    def track_import(self):
        """Return the processor time of a process that imports quietarm [s]."""
        return _seconds("import quietarm as qa; qa.PointToPoint")

    def track_first_plan(self):
        """Return the processor time of a process that plans one move [s]."""
        return _seconds(
            "import quietarm as qa; from math import pi;"
            "qa.plan_move(qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8))"
        )

    track_import.unit = track_first_plan.unit = "s"


def _seconds(program):
    """The least processor time of three processes that run a program [s]."""
    timed = (
        "import resource, subprocess, sys;"
        "subprocess.run([sys.executable, '-c', sys.argv[1]], check=True);"
        "used = resource.getrusage(resource.RUSAGE_CHILDREN);"
        "print(used.ru_utime + used.ru_stime)"
    )
    command = [sys.executable, "-c", timed, program]
    runs = [subprocess.run(command, capture_output=True, text=True, check=True) for _ in range(3)]
    return min(float(run.stdout) for run in runs)
