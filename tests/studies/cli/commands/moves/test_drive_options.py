"""--drive, and cycles of --return, as typed."""

import csv
import json
import re
from pathlib import Path

import pytest
from pages import ROOT

import quietarm as qa
from quietarm.machine.identify import Identified

AXIS = (
    "plan linear-axis --set omega1=12Hz --set zeta1=0.004 --set mass=6kg --set load=1.17kg "
    "--set friction=6 --target 0.25 --duration 0.314 --terms 2"
)
DRIVE = (
    "--drive position_loop=90/s,speed_loop=60Hz,reset_time=20ms,recorded=held "
    "--drive friction_motor=3N "
    "--drive friction-load=2N,dead_time=0.25ms,compliance=6N/um,rotor=2kg"
)


def test_an_answer_is_judged_on_its_drive_and_says_what_is_unknown(call):
    code, out, _ = call(f"{AXIS} {DRIVE} --output move.json --output move.csv")
    assert code == 0
    assert "position loop 90 1/s, speed loop 60 Hz" in out
    assert "drive unknown" in out
    assert "motor constant" in out
    assert "12 Hz (0.4 %) with the joint held" in out
    assert "on the drive" in out
    plan = qa.Plan.load("move.json")
    assert plan.task.plant.drive.compliance == pytest.approx(1 / 6e6)
    assert plan.task.plant.drive.friction_load == 2
    assert call("export move.json --output rows.csv")[0] == 0
    with open("rows.csv", newline="") as file:
        *_, last = csv.DictReader(file)
    # the servo settles after arrival: rows go on until then
    assert float(last["time_s"]) > 0.32
    assert float(last["position_m"]) == pytest.approx(0.25)


@pytest.mark.slow
def test_a_drive_that_no_machine_has_is_warned_of_beside_the_answer(call):
    drive = "--drive position_loop=600/s,speed_loop=40Hz,recorded=held,rotor=2kg,compliance=6N/m"
    evaluated = AXIS.replace("plan", "evaluate").replace("--terms 2", "--coefficients 0,0")
    code, out, _ = call(f"{evaluated} {drive}")
    assert code == 0
    first, *rows = " ".join(out.split()).split(" move linear-axis")
    assert "n its drive it leaves" in first
    # 2 pi * 40 Hz
    assert "position loop of 600/s is faster than the speed loop of 40 Hz, which is 251" in rows[0]
    assert re.search(
        r"gives by \S+ m at the plan's peak, and its way is 0.25 m; check the", rows[0]
    )
    _, out, _ = call(f"{evaluated} {DRIVE}")
    assert "warning the position" not in " ".join(out.split())
    assert "gives by" not in out


@pytest.mark.slow
def test_without_loops_there_is_no_simulation(call):
    _, out, _ = call(f"{AXIS} --drive friction_load=5N")
    assert "not simulated: give position_loop and speed_loop" in out


def test_cycles_have_effort_heat_energy_and_what_builds_up(call):
    code, out, _ = call(f"{AXIS} --return --dwell 100ms --repeat 5 --output move.json")
    assert code == 0
    assert "there and back in 0.828 s with a dwell of 0.1 s after each move" in out
    assert "heat unknown without motor_constant in --drive" in out
    assert "left in 5 cycles" in out
    assert "if frequency" in out
    stated = json.loads(Path("move.json").read_text())["stated_cycle"]
    assert stated["time"] == pytest.approx(0.828)
    assert stated["energy"] > stated["energy_with_recovery"]


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("--drive speed=40Hz", "a drive has no number 'speed'; did you mean 'speed_loop'?"),
        ("--drive speed_loop=-1", "speed loop is -1; give a positive number"),
        ("--drive speed_loop=fast", "'fast' is not a speed loop; give hertz (40) or 40Hz"),
        ("--drive compliance=6kg", "'6kg' is not a compliance; give m/N (1.7e-7), 0.17um/N, or a"),
        ("--drive rotor=80kg", "rotor is 80 kg of 4.83 kg that move without what swings"),
        (
            "--drive position_loop=90/s,speed_loop=60Hz",
            "how they were recorded is not stated; give recorded=held",
        ),
        ("--drive recorded=never", "recorded is 'never'; give held or moving"),
        ("--drive speed_loop=1,speed_loop=2", "speed_loop is given twice; give it once"),
        ("--dwell 0.3", "--dwell is for cycles of --return; leave it out"),
        ("--return --repeat 0", "repeat is 0; give a whole number from 1 up"),
        ("--return --profile free", "--return is not for free"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(refused, typed, words):
    line = AXIS.replace(" --terms 2", "") if "free" in typed else AXIS
    assert words in refused(f"{line} {typed}")


@pytest.mark.slow
def test_a_servo_that_does_not_hold_the_plant_is_warned_of_beside_the_plan(call):
    code, out, _ = call(
        f"{AXIS} --drive position_loop=90/s,speed_loop=60Hz,dead_time=20ms,recorded=held"
    )
    assert code == 0
    assert "warning: the servo does not hold the plant" in out


RECORDING = (
    f"identify {ROOT}/docs/recordings/gantry.csv linear-axis --tip tool_mm --set mass=82.7kg "
    "--set load=15kg --assume all --output gantry.json"
)
LOOPS = "--drive position_loop=60/s,speed_loop=40Hz,reset_time=30ms"
ON_LOOPS = f"plan gantry.json --target 0.8 --duration 1.017 --terms 2 {LOOPS}"


def test_a_machines_file_says_how_it_was_recorded(call, refused):
    assert call(RECORDING)[0] == 0
    assert "recorded" not in json.loads(Path("gantry.json").read_text())
    assert "give recorded=held" in refused(ON_LOOPS)
    assert call(f"{RECORDING} --recorded moving")[0] == 0
    assert Identified.load("gantry.json").recorded == "moving"
    _, out, _ = call(ON_LOOPS)
    assert "as recorded on the moving servo" in out
    _, out, _ = call(f"{ON_LOOPS},recorded=held")
    assert "as recorded with the joint held" in out
    told = " ".join(out.split())
    assert "the machine's file says that it was recorded moving, which is not used" in told
    assert "give recorded=held" in refused(f"{ON_LOOPS} --set omega1=4.5Hz")


@pytest.mark.slow
def test_a_band_that_a_slow_servo_does_not_keep_is_warned_of(call):
    """A gripper of 12 Hz on a servo of 20 Hz, docs/servo.md; at 60 Hz it is kept."""
    move = AXIS.replace(" --terms 2", " --jerk-limit 1500 --acceleration-limit 22 --band 0.1mm")
    slow = "--drive position_loop=30/s,speed_loop=20Hz,reset_time=60ms,compliance=0,rotor=1.2kg"
    rest = "friction_motor=3N,friction_load=2N,dead_time=0.25ms,recorded=held"
    _, out, _ = call(f"{move} {slow},{rest}")
    told = " ".join(out.split())
    left = re.search(r"worst on it ([\d.]+) mm with frequency [+-]5 % left \(warning: beyond", told)
    assert float(left[1]) == pytest.approx(0.136, abs=0.02)
    quick = "--drive position_loop=90/s,speed_loop=60Hz,reset_time=20ms,compliance=0,rotor=1.2kg"
    _, out, _ = call(f"{move} {quick},{rest}")
    assert "worst on it" in out
    assert "beyond the band" not in out
