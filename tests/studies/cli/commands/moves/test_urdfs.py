"""Answers of commands on a robot whose URDF has, lacks or repeats what bears on them."""

import csv
from pathlib import Path

import pytest
from two_links import INERTIAL, LIMIT, URDF, with_elbow

import quietarm as qa

BAR = (
    "beam: {at: lower, length: 0.5, width: 8mm, height: 12mm, youngs_modulus: 70GPa, "
    "density: 2700, tip_mass: 0.2, pieces: 1}"
)
GEARS = "elastic_joints: {shoulder: {stiffness: 10000, damping: 5}, elbow: 5000}"
ROTORS = "rotor_inertia: {shoulder: 0.5, elbow: 0.3}"
ENDS = "--start=0,0.3 --target=1,1 --duration 1"


def robot(text, *entries):
    """Files of a robot of this URDF."""
    Path("two.urdf").write_text(text)
    Path("two.yaml").write_text("\n".join(["urdf: two.urdf", *entries]) + "\n")


def said(answer):
    code, out, err = answer
    assert code == 0, err
    return " ".join(out.split()), " ".join(err.split())


@pytest.mark.slow
def test_a_robot_without_masses_says_so_beside_energy_and_torque(call):
    robot(URDF.replace(INERTIAL, ""), BAR)
    words = "the URDF has no masses of moving links: energy and torque are of the beam alone"
    listed, _ = said(call("list two.yaml"))
    assert "masses [kg] none in the URDF" in listed
    assert f"warning {words}" in listed
    for asked in ("--coefficients=0 -o a.json", "--profile zv"):
        rows, _ = said(call(f"evaluate two.yaml {ENDS} {asked}"))
        energy, residual = rows.index("energy"), rows.index("residual")
        torque, speed = rows.index("peak torque"), rows.index("peak speed")
        assert f"(warning: {words}" in rows[energy:residual]
        assert f"(warning: {words}" in rows[torque:speed]
        assert "warning" not in rows[residual:torque]
    compared, _ = said(call("compare a.json"))
    assert f"warning: {words}" in compared
    line = f"search two.yaml {ENDS} --bound 0.2 --terms 2 --population 4 --generations 1"
    _, err = said(call(line))
    assert f"warning: {words}" in err


def test_damping_and_friction_of_the_urdf_count(call):
    """Each joint turns by its way: viscous torque by speed, and Coulomb's by the way alone."""
    robot(with_elbow('<dynamics damping="5" friction="3"/>'), BAR)
    line = f"evaluate two.yaml {ENDS} --coefficients=0 --output a.json"
    said(call(line))
    plan = qa.Plan.load("a.json")
    assert plan.task.plant.robot.friction == {"elbow": 5.0}
    with_friction = plan.motion.net_work
    assert "friction elbow 5 N m s/rad (the URDF's damping)" in said(call("list two.yaml"))[0]
    robot(URDF, BAR)
    said(call(line))
    # of a cycloid the mean square speed is 1.5 times that of the way in the duration
    work = 5.0 * 1.5 * 0.7**2 + 3.0 * 0.7
    assert with_friction - qa.Plan.load("a.json").motion.net_work == pytest.approx(work, rel=1e-3)


@pytest.mark.slow
def test_friction_of_the_robots_file_wins_and_it_is_said(call):
    robot(with_elbow('<dynamics damping="5"/>'), BAR, "friction: {elbow: 2}")
    words = "friction as given in place of the URDF's damping: elbow 2 (URDF 5) N m s/rad"
    assert f"warning {words}" in said(call("list two.yaml"))[0]
    assert f"warning {words}" in said(call(f"evaluate two.yaml {ENDS} --coefficients=0"))[0]


@pytest.mark.slow
def test_limits_of_urdf_1_2_are_kept(call):
    more = 'velocity="3" acceleration="5" deceleration="4" jerk="60"'
    robot(URDF.replace('velocity="3"', more), BAR, "limits: urdf")
    listed, _ = said(call("list two.yaml"))
    assert "acceleration limit shoulder 4, elbow 4 rad/s^2" in listed
    assert "jerk limit shoulder 60, elbow 60 rad/s^3" in listed
    assert "the URDF's limits of deceleration are smaller, and are kept while" in listed
    said(call(f"evaluate two.yaml {ENDS} --coefficients=0 --output a.json"))
    task = qa.Plan.load("a.json").task
    assert dict(task.acceleration_limit) == {"shoulder": 4.0, "elbow": 4.0}
    assert dict(task.jerk_limit) == {"shoulder": 60.0, "elbow": 60.0}


@pytest.mark.slow
def test_joints_that_mimic_others_follow_them(call, refused):
    robot(with_elbow('<mimic joint="shoulder" multiplier="-1" offset="0.1"/>'), GEARS, ROTORS)
    assert "following elbow = -1 shoulder +0.1" in said(call("list two.yaml"))[0]
    words = (
        "--start has 2 positions, and the robot drives 1 joint, shoulder (elbow follows shoulder)"
    )
    assert words in refused(f"plan two.yaml {ENDS}")
    line = "evaluate two.yaml --start=0.2 --target=1 --duration 1 --coefficients=0"
    assert "two (1 joint; gears), along its path in 1 s" in said(call(f"{line} -o a.json"))[0]
    said(call("export a.json --output a.csv --columns angle"))
    with open("a.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["angle_rad"]) == pytest.approx(1.0)
    assert float(rows[-1]["elbow_angle_rad"]) == pytest.approx(-0.9)
    # a controller moves what it drives, by its name, from where it is to where it goes
    said(call("export a.json --output a.yaml --rate 2"))
    assert Path("a.yaml").read_text().startswith("joint_names:\n- 'shoulder'\npoints:\n")
    said(call("export a.json --output a.c"))
    assert "#define A_JOINTS 1" in Path("a.h").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("command", ["list two.yaml", f"plan two.yaml {ENDS}"])
def test_motors_without_inertia_are_told_what_to_give(refused, command):
    robot(URDF, GEARS)
    words = "elastic_joints needs rotor_inertia of shoulder, elbow (motor's inertia times the gear"
    assert words in refused(command)


@pytest.mark.slow
def test_one_spring_is_one_mode(call):
    robot(URDF, "elastic_joints: {shoulder: {stiffness: 10000, damping: 5}}")
    listed, _ = said(call("list two.yaml"))
    assert "modes 18.6 Hz, sag" in listed  # of one mode, as the shoulder's gear and 2 kg have
    assert said(call(f"evaluate two.yaml {ENDS} --coefficients=0"))


@pytest.mark.slow
@pytest.mark.parametrize(("old", "new", "words"), [
    (LIMIT, LIMIT.replace('lower="-2" upper="2"', 'lower="2" upper="-2"'),
     "limit of joint 'shoulder' of the URDF: lower 2 is above upper -2; swap or mend them"),
    ("</robot>", '<link name="lower"/></robot>', "two links are called 'lower' in the URDF; give"),
    ('xyz="0.5 0 0"', 'xyz="500 0 0"', "links are 500 m long; are origins in mm?"),
])  # fmt: skip
def test_a_urdf_is_refused_in_a_line(refused, old, new, words):
    upright = URDF.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')
    robot(upright.replace(old, new, 1), GEARS, ROTORS)
    assert words in refused("list two.yaml")


def test_what_is_not_read_of_a_urdf_is_named(call):
    robot(URDF.replace('effort="50"', 'effort="50" current="7"'), BAR)
    words = "warning not read of the URDF: current of limit"
    assert words in said(call("list two.yaml"))[0]
    assert words in said(call(f"evaluate two.yaml {ENDS} --coefficients=0 -o a.json"))[0]
    # the plan's file has it, too
    assert "warning: not read of the URDF: current of limit" in said(call("compare a.json"))[0]
