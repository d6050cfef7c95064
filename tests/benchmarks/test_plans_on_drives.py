"""Plans for a stated drive, run by the machines of docs/drive.md: their equations are others."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from parts.drive.machines import GANTRY, PICKER
from parts.drive.moves import MOVES
from parts.drive.simulate import SetPoints, simulate

from quietarm import Drive, plan_move

DURATIONS = {"gantry": 1.017, "picker": 0.314}  # of ZVD over ruckig


def drive_of(machine, recorded):
    """Return the drive of a machine as its user knows it: loops, belt, rotor and dry friction."""
    servo = machine.servo
    return Drive(
        position_loop=servo.position_gain,
        speed_loop=servo.speed_loop,
        reset_time=servo.reset_time,
        compliance=1 / machine.belt if machine.belt else 0.0,
        rotor=machine.rotor,
        friction_motor=machine.motor_friction.sliding,
        friction_load=machine.guide_friction.sliding,
        dead_time=servo.delay / 4000,
        recorded=recorded,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("machine", "recorded", "hertz", "damping"),
    [
        (GANTRY, "held", 4.5, 0.006),  # as its base is held
        (GANTRY, "moving", 4.484, 0.0047),  # docs/drive_recording.md, recorded while the axis moves
        (PICKER, "held", 12.0, 0.004),
        (PICKER, "moving", 11.866, 0.0046),
    ],
)
def test_a_nominal_plan_leaves_a_twentieth_of_a_millimetre_on_a_machine(
    machine, recorded, hertz, damping
):
    move = MOVES[machine.name]
    duration = DURATIONS[machine.name]
    task = move.task(hertz, damping, duration)
    plant = replace(task.plant, drive=drive_of(machine, recorded))
    plan = plan_move(replace(task, plant=plant))
    points = plan.candidate.set_points(1000.0)
    run = simulate(
        [machine], [SetPoints(points.time, points.place, points.speed, points.acceleration)]
    )
    left = np.abs(run.tool[run.time >= duration] - move.target).max()
    assert left < 5e-5
    # the plan's own judge has no encoder, no further modes and no breakaway friction
    assert plan.candidate.on_drive.residual == pytest.approx(left, abs=2e-5)
    assert plan.candidate.on_drive.peak_torque == pytest.approx(np.abs(run.force).max(), rel=0.1)
