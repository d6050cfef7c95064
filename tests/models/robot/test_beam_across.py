"""A beam that lies otherwise than along z of its link, held against a link where it lies."""

import numpy as np
import pytest
from robots import BAR, UR5_JOINTS, straight, urdf_of
from small_robots import ARM, FILE, torques_of, write_robot

import quietarm as qa
from quietarm.ocp.saved import plain, typed

BEAM = {
    "length": 0.5, "width": 0.006, "height": 0.01, "youngs_modulus": 70e9, "density": 2700.0,
    "tip_mass": 0.3, "damping": 0.005, "pieces": 2,
}  # fmt: skip
HALF = np.pi / 2


def arm(urdf=ARM, **beam):
    return qa.Robot(urdf=urdf, joints=("a", "b"), held={"grip": 0.02}, beam=qa.Beam(**BEAM, **beam))


def with_clamp(xyz, rpy, roll):
    """The arm with links where the beam is clamped, the second turned about the beam."""
    links = "".join(
        f'<link name="{name}"/><joint name="to {name}" type="fixed"><parent link="{before}"/>'
        f'<child link="{name}"/><origin xyz="{place}" rpy="{turned}"/></joint>'
        for name, before, place, turned in (
            ("clamp", "tool", xyz, rpy), ("rolled", "clamp", "0 0 0", f"0 0 {roll}"),
        )
    )  # fmt: skip
    return ARM.replace("</robot>", f"{links}</robot>")


@pytest.mark.parametrize(("direction", "rpy"), [
    ((1.0, 0.0, 0.0), (0.0, HALF, 0.0)),
    ((0.0, 2.0, 0.0), (-HALF, 0.0, 0.0)),
    ((0.0, -0.1, 0.0), (HALF, 0.0, 0.0)),
    ((0.0, 0.0, -3.0), (np.pi, 0.0, 0.0)),
    ((1.0, 0.0, 1.0), (0.0, HALF / 2, 0.0)),
])  # fmt: skip
def test_a_direction_an_offset_and_a_turn_are_those_of_a_link_there(direction, rpy):
    roll = 0.4
    across = arm(at="tool", direction=direction, offset=(0.1, 0.02, -0.05), roll=roll)
    turned = " ".join(map(repr, map(float, rpy)))
    linked = arm(with_clamp("0.1 0.02 -0.05", turned, roll), at="rolled")
    positions = np.array([0.3, -0.4, 0.01, 0.02, 0.03, -0.02])
    speeds = np.array([1.0, 2.0, 0.1, 0.2, 0.3, 0.4])
    accelerations = np.array([3.0, -1.0, 1.0, 2.0, 3.0, 4.0])
    torques = [torques_of(robot, positions, speeds, accelerations) for robot in (across, linked)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-12)
    ends = [robot.kinematics("beam end").pose(positions[:2]) for robot in (across, linked)]
    assert ends[0].origin == pytest.approx(ends[1].origin, abs=1e-14)
    assert ends[0].rotation == pytest.approx(ends[1].rotation, abs=1e-14)


def test_across_a_link_its_width_lies_along_y():
    """Turned from z to x: its z is the link's x, its x the link's -z, and y stays."""
    frame = qa.Beam(at="tool", **BEAM, direction=(1, 0, 0)).frame
    assert frame.rotation == pytest.approx(np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]), abs=1e-15)


def test_a_robots_file_says_where_the_beam_lies(tmp_path):
    entries = FILE.replace("at: tool", "at: tool, direction: [1, 0, 0], offset: [0, 20mm, 0.1]")
    beam = qa.Robot.load(write_robot(tmp_path, ARM, entries)).beam
    assert (beam.direction, beam.offset) == ((1.0, 0.0, 0.0), (0.0, 0.02, 0.1))
    entries = FILE.replace("at: tool", "at: tool, roll: 90deg")
    assert qa.Robot.load(write_robot(tmp_path, ARM, entries)).beam.roll == pytest.approx(HALF)


def test_a_saved_beam_states_its_place_only_where_it_is_another():
    usual = qa.Beam(at="tool", **BEAM)
    assert not {"direction", "offset", "roll"} & plain(usual).keys()
    across = qa.Beam(at="tool", **BEAM, direction=(0, 1, 0), offset=(0.1, 0, 0))
    assert typed(plain(across), qa.Beam) == across


@pytest.mark.parametrize(("entries", "words"), [
    ({"direction": (0.0, 0.0, 0.0)}, r"direction of the beam is \[0.0, 0.0, 0.0\], none; give one"),
    ({"direction": (1.0, 0.0)}, r"direction .*; give three numbers, such as \[1, 0, 0\]"),
    ({"direction": "x"}, "direction of the beam is 'x'; give three numbers"),
    ({"direction": None}, "direction of the beam is None; give three numbers"),
    ({"offset": (0.0, float("nan"), 0.0)}, "offset of the beam is nan; give a finite number in m"),
    ({"offset": (100.0, 0.0, 5000.0)}, "offset of the beam is 5000 m; give at most 1000 m"),
    ({"roll": float("inf")}, "roll of the beam is inf; give a finite number in rad"),
])  # fmt: skip
def test_what_is_no_place_of_a_beam_is_refused(entries, words):
    with pytest.raises(ValueError, match=words):
        qa.Beam(at="tool", **BEAM, **entries)


@pytest.mark.slow
def test_a_bar_across_the_flange_swings_as_mujoco_says():
    """The plain cycloid of the UR5, whose bar lies along x of its flange, 5 cm before it."""
    from mujoco_robots import FlexibleRobot, Truth, motion_of

    beam = qa.Beam(at="tool0", **BAR, direction=(1, 0, 0), offset=(0.0, 0.0, 0.05))
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=beam)
    plan = qa.evaluate_coefficients(qa.PointToPoint(robot.along(straight()), 1.0, 1.0), [])
    bodies = FlexibleRobot(urdf_of("ur5_robot.urdf"))
    bodies.add_fixed("flange", "tool0", (0.0, 0.0, 0.05), (0.0, HALF, 0.0))
    hinges = bodies.add_bar("flange", **BAR, pieces=6)
    truth = Truth(bodies, UR5_JOINTS, BAR["damping"], hinges)
    residual, energy, _ = truth.residual_and_energy(motion_of(plan), 1.0)
    assert plan.energy == pytest.approx(energy, rel=2e-3)
    assert plan.candidate.in_full.residual == pytest.approx(residual, rel=0.02)
