"""From Klipper's recording of a belt axis to a quiet move: the line as a user types it."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

from quietarm.machine.identify import Identified
from quietarm.ocp import Plan

pytestmark = pytest.mark.slow

# a tool head of 0.4 kg on a belt, whose motor is held: 35 Hz and a damping ratio of 0.05
MASS, STIFFNESS = 0.4, 0.4 * (2 * np.pi * 35) ** 2
FRICTION = 2 * 0.05 * np.sqrt(STIFFNESS * MASS)
RATE = 3200.0  # of an ADXL345 [Hz]
STEP = 38.3  # of its counts, 3.9 thousandths of g [mm/s^2]


def head(force, time, output):
    """The way of the head, or its acceleration, that a force on it gives."""
    A, B = [[0.0, 1.0], [-STIFFNESS / MASS, -FRICTION / MASS]], [[0.0], [1 / MASS]]
    C, D = ([[1.0, 0.0]], [[0.0]]) if output == "way" else (A[1:], B[1:])
    return lsim((A, B, C, D), force, time)[1]


def klipper_text(rng):
    """Four taps on the head, as raw_data_x.csv has them."""
    time = np.arange(0, 6, 1 / RATE)
    force = np.zeros_like(time)
    for at, size in ((0.4, 40.0), (1.9, -55.0), (3.3, 35.0), (4.7, 50.0)):
        force[int(at * RATE) : int((at + 0.004) * RATE)] = size
    x = 1e3 * head(force, time, "acceleration")
    columns = (STEP * np.round((of + rng.normal(0, 2 * STEP, len(time))) / STEP)
               for of in (x, 0.02 * x, 9810 + 0 * x))  # fmt: skip
    rows = zip(80.0 + time, *columns, strict=True)
    return "#time,accel_x,accel_y,accel_z\n" + "".join(
        "{:.6f},{:.6f},{:.6f},{:.6f}\n".format(*row) for row in rows
    )


def test_a_belt_axis_is_identified_and_moved_to_rest(done):
    Path("raw_data_x.csv").write_text(klipper_text(np.random.default_rng(3)))
    done(
        "identify raw_data_x.csv linear-axis --acceleration accel_x --units acceleration:mm/s^2 "
        "--set mass=1.2 --set load=400g --assume share1,friction --output belt.json "
        "--output fit.png --quiet"
    )
    found = Identified.load("belt.json")
    omega, zeta = found.estimates
    assert found.not_identifiable == {}
    assert [omega.parameter, zeta.parameter] == ["omega1", "zeta1"]
    assert omega.next_low < 2 * np.pi * 35 < omega.next_high
    assert zeta.value == pytest.approx(0.05, rel=1e-2)
    out = done(
        "plan belt.json --error measured --target 300mm --duration 0.3 --acceleration-limit 15 "
        "--quiet --output plan.json --output plan.csv"
    )
    assert "0 to 300 mm in 0.3 s" in out
    # the motor's path, on the belt of above
    plan, time = Plan.load("plan.json"), np.arange(0, 1.0, 1e-4)
    seen = head(-MASS * plan.sampled(time).joint[:, 2], time, "way")  # from the motor
    assert np.abs(seen[time > 0.3]).max() < 0.01 * np.abs(seen).max()
