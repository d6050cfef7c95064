"""One table of a plan, whichever command or method writes it; tables of 2.0 are read."""

import re
from pathlib import Path

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp.planning.move_table import move_csv

COLUMNS_OF_2_0 = {
    # what `plan --output move.csv` and `Plan.save_csv` of 2.0.0 wrote, and `export`
    "plan": "time,angle,speed,acceleration,tip,torque,power",
    "export": "time,angle,speed,acceleration",
}
HEADINGS_OF_2_0 = {
    "plan": "time_s,angle_rad,speed_rad_s,acceleration_rad_s2,tip_m,torque_Nm,power_W",
    "export": "time_s,angle_rad,speed_rad_s,acceleration_rad_s2",
}


def test_both_methods_write_the_same_table(cycloid, folder):
    cycloid.save_csv("saved.csv", 100.0)
    qa.views.export_plan(cycloid, "exported.csv", rate=100.0)
    text = Path("saved.csv").read_text()
    assert text == Path("exported.csv").read_text() == move_csv(cycloid, rate=100.0)
    assert text.startswith(f"{HEADINGS_OF_2_0['plan']}\n0,0,0,0,0,0,0\n")
    assert len(text.splitlines()) == 1 + 81  # 0.8 s at 100 Hz


@pytest.mark.slow
def test_every_command_and_method_writes_the_same_table(done, folder):
    done(
        "evaluate single-link --target 30deg --duration 0.8 --coefficients=0.003,-0.17 --quiet "
        "--output plan.json --output plan.csv --output plan.txt"
    )
    done("export plan.json --output export.csv --quiet")
    plan = qa.Plan.load("plan.json")
    plan.save_csv("saved.csv")
    qa.views.export_plan(plan, "python.csv")
    names = ("plan.csv", "plan.txt", "export.csv", "saved.csv", "python.csv")
    (text,) = {Path(name).read_text() for name in names}
    assert text.startswith(f"{HEADINGS_OF_2_0['plan']}\n0,0,0,0,0,0,0\n")
    assert len(text.splitlines()) == 1 + 801  # 0.8 s at 1 kHz


@pytest.mark.parametrize("writer", COLUMNS_OF_2_0)
def test_a_table_of_2_0_is_a_path(cycloid, done, folder, writer):
    text = move_csv(cycloid, COLUMNS_OF_2_0[writer], 200.0)
    assert text.startswith(f"{HEADINGS_OF_2_0[writer]}\n")
    Path("path.csv").write_text(text)
    told = done("evaluate single-link --path path.csv")
    energy = float(re.search(r"energy +([0-9.]+) J", told)[1])
    assert energy == pytest.approx(cycloid.energy, rel=1e-4)


@pytest.mark.slow
def test_a_table_of_2_0_is_a_recording(cycloid, done, folder):
    """The columns that `identify` takes, over the move and the swing after it."""
    motion = cycloid.sampled(np.arange(0, 4000) / 500)
    angle, speed, acceleration = motion.joint.T
    rows = np.column_stack(
        [motion.time, angle, speed, acceleration, motion.tips, motion.torque, motion.power]
    )
    header = HEADINGS_OF_2_0["plan"]
    np.savetxt("push.csv", rows, delimiter=",", header=header, comments="", fmt="%.10g")
    told = done(
        "identify push.csv flexible-beam --tip tip_m --angle angle_rad --assume all --quiet "
        "--set tip_mass=0"
    )
    found = float(re.search(r"omega +([0-9.]+) Hz", told)[1])
    assert 2 * np.pi * found == pytest.approx(cycloid.task.plant.omega, rel=0.01)
