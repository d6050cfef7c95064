"""`quietarm identify`, and machines in the place of plants."""

import math

import numpy as np
import pytest
from quietarm.ocp import Plan
from quietarm.studies.identify import Identified
from scipy.io import savemat

TIME = np.arange(0, 6, 0.005)
OMEGA, ZETA = 2 * math.pi * 3.2, 0.01
SWING = np.exp(-ZETA * OMEGA * TIME) * np.cos(OMEGA * math.sqrt(1 - ZETA**2) * TIME)
TIP = 20 * SWING + np.random.default_rng(0).standard_normal(len(TIME))  # mm
PUSH = "identify push.csv flexible-beam --quiet --tip tip_mm"


@pytest.fixture
def push(folder):
    rows = "".join(f"{t:.3f},{tip:.1f}\n" for t, tip in zip(TIME, TIP, strict=True))
    (folder / "push.csv").write_text(f"time_s,tip_mm\n{rows}")
    rows = "".join(f"{1e3 * t:.0f},{tip:.1f}\n" for t, tip in zip(TIME, TIP, strict=True))
    (folder / "ms.csv").write_text(f"time,tip\n{rows}")
    return folder


def test_a_push_makes_a_machine_that_is_planned_for(push, call):
    code, out, err = call(f"{PUSH} --set length=0.6 --output arm.json --figure fit.png")
    assert (code, err) == (0, "")
    assert " Hz, within 3." in out
    assert "wrote arm.json" in out
    assert (push / "fit.png").read_bytes().startswith(b"\x89PNG")
    found = Identified.load(push / "arm.json")
    assert found.plant.length == 0.6
    code, out, err = call(
        "plan arm.json --quiet --set friction=0.02 --target 30deg --duration 1 --error measured "
        "--output plan.json"
    )
    assert (code, err) == (0, "")  # friction shows in the torque alone
    task = Plan.load(push / "plan.json").task
    assert task.ranges == found.errors
    assert (task.plant.friction, task.plant.omega) == (0.02, found.plant.omega)


def test_another_tip_mass_keeps_the_measured_frequency_and_says_so(push, call, refused):
    call(f"{PUSH} --output arm.json")
    beam = Identified.load(push / "arm.json").plant
    line = "plan arm.json --quiet --target 30deg --duration 1"
    code, _, err = call(f"{line} --set tip_mass=0.1 --output plan.json")
    assert (code, Plan.load("plan.json").task.plant.omega) == (0, beam.omega)
    loaded = beam.carrying(0.1).omega / math.tau
    assert "tip_mass is 0.1 kg, and was 0.036 kg" in err
    assert f"--set omega={loaded:.4g}Hz" in err
    for quiet in ("", "--set tip_mass=36g", "--set tip_mass=0.1 --set omega=2Hz"):
        assert call(f"{line} {quiet}")[2] == ""
    for name, value in {"omega": "3Hz", "tip_mass": "0.1", "length": "0.5"}.items():
        said = refused(f"{line} --set {name}={value} --error measured")
        assert f"the measured intervals are of the machine with {name} " in said
        assert "or state errors of your own, as frequency=5%" in said
    said = refused("sweep arm.json --quiet --target 1 --duration 1 --set omega=3Hz,3.1Hz "
                   "--error measured --output m.zarr")  # fmt: skip
    assert "with omega" in said


def test_files_of_other_programs_tell_the_same(push, call):
    np.save(push / "push.npy", np.column_stack([TIME, TIP]))
    savemat(push / "push.mat", {"t": TIME, "w": TIP, "rate": 200.0})
    rows = "".join(f"{t:.3f},{a:.2f},0,9810\n" for t, a in zip(TIME, 1e3 * SWING, strict=True))
    (push / "push-raw.csv").write_text(f"#time,accel_x,accel_y,accel_z\n{rows}")
    (push / "german.csv").write_text((push / "push.csv").read_text().translate({44: 59, 46: 44}))
    for line in (
        PUSH,
        "identify push.npy flexible-beam --time 0 --tip 1 --units tip:mm",
        "identify push.mat flexible-beam --tip w",
        "identify push-raw.csv flexible-beam --acceleration accel_x --units acceleration:mm/s^2",
        "identify german.csv flexible-beam --tip tip_mm",
    ):
        code, _, err = call(f"{line} --quiet --output arm.json")
        assert (code, err) == (0, "")
        omega, zeta = Identified.load(push / "arm.json").told
        assert omega.low < OMEGA < omega.high, line
        assert zeta.value == pytest.approx(ZETA, rel=0.1)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("identify push.csv flexible-beam --quiet", "give the column of what rings"),
        (f"{PUSH.replace('tip_mm', 'tip')}", "unknown column 'tip'; did you mean 'tip_mm'?"),
        (f"{PUSH} --units tip:inch", "unknown unit of tip 'inch'"),
        (f"{PUSH} --units time:ms", "column time_s is in s by its name and in ms as given"),
        ("identify ms.csv flexible-beam --tip tip", "0.00319 Hz, as no arm does"),
        (
            "plan single-link --target 1 --duration 1 --error measured",
            "--error measured is for an identified machine",
        ),
    ],
)
def test_what_cannot_be_is_refused(push, refused, line, said):
    assert said in refused(line)
