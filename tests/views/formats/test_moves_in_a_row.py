"""Several moves in one trajectory, one after another: stops and pauses."""

import numpy as np
import pytest
import yaml
from small_robots import ARM

import quietarm as qa
from quietarm.models import TimedMotion
from quietarm.views.formats.trajectory_points import points_of_several

BEAM = {
    "length": 0.5, "bending_stiffness": 30.0, "mass_per_length": 0.2, "tip_mass": 0.3, "pieces": 2,
}  # fmt: skip
PLACES = ([0.0, 0.1], [0.5, 0.3], [0.2, 0.6])


@pytest.fixture(scope="module")
def moves():
    """Two plain cycloids of the arm, the second from where the first stops."""
    robot = qa.Robot(
        urdf=ARM, joints=("a", "b"), held={"grip": 0.02}, beam=qa.Beam("tool", **BEAM), modes=1
    )
    return [
        qa.evaluate_coefficients(
            robot.along(qa.GeometricPath.line(begin, end)).task(1.0, duration), []
        )
        for begin, end, duration in zip(PLACES, PLACES[1:], (0.6, 0.455))
    ]


def exported(moves, tmp_path, name="moves.moveit", **settings):
    plans = {f"move {number}": plan for number, plan in enumerate(moves)}
    (path,) = qa.views.export_plan(plans, tmp_path / name, **settings)
    return path


def test_points_of_moves_are_one_after_another(moves):
    points, ends = points_of_several(moves, 100.0, None, 0.4)
    assert ends == pytest.approx([0.6, 1.46])  # the second to the tick after arrival
    assert np.diff(points.times).min() > 0
    assert points.times[60:62] == pytest.approx([0.6, 1.0])
    assert points.positions[[60, 61]] == pytest.approx(np.array([PLACES[1]] * 2), abs=1e-9)
    assert points.speeds[60:62] == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    points, ends = points_of_several(moves, 100.0, None, 0.0)
    assert ends == pytest.approx([0.6, 1.06])
    assert len(points.times) == 61 + 47 - 1  # the stop is one point
    assert np.diff(points.times) == pytest.approx(0.01)


@pytest.mark.slow
def test_a_pause_lies_between_two_moves(moves, tmp_path):
    path = exported(moves, tmp_path, rate=100.0, pause=0.4)
    motion = TimedMotion.load(path)
    assert motion.joints == ("a", "b")
    assert motion.duration == pytest.approx(0.6 + 0.4 + 0.46)  # to the tick after arrival
    message = yaml.safe_load(path.read_text())["joint_trajectory"]
    times = [p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"]
             for p in message["points"]]  # fmt: skip
    assert np.diff(times).min() > 0
    assert len(times) == 61 + 47
    stop, start = message["points"][60:62]
    for point, time in ((stop, 0.6), (start, 1.0)):
        assert point["positions"] == pytest.approx(PLACES[1], abs=1e-9)
        assert point["velocities"] == pytest.approx([0, 0], abs=1e-9)
        assert point["time_from_start"]["sec"] + 1e-9 * point["time_from_start"][
            "nanosec"
        ] == pytest.approx(time)
    assert message["points"][-1]["positions"] == pytest.approx(PLACES[2], abs=1e-9)


def test_moves_that_do_not_join_are_refused(moves):
    words = "move 1 ends with 'b' at 0.6, and move 2 begins with it at 0.1; give each move from"
    with pytest.raises(ValueError, match=words):
        points_of_several(moves[::-1], 100.0, None, 0.0)
    path = qa.GeometricPath.line([0.5], [0.2], joints=("a",))
    one = qa.Robot(
        urdf=ARM, joints=("a",), held={"grip": 0.02}, beam=qa.Beam("tool", **BEAM), modes=1
    )
    other = qa.evaluate_coefficients(one.along(path).task(1.0, 0.6), [])
    with pytest.raises(ValueError, match="move 1 is of a, b and move 2 of a; give moves of the"):
        points_of_several([moves[0], other], 100.0, None, 0.0)


@pytest.mark.slow
def test_moves_of_one_joint_are_joined_as_well(tmp_path):
    plant = qa.SingleLinkManipulator()
    there = qa.evaluate_coefficients(plant.task(0.5, 0.8), [])
    back = qa.evaluate_coefficients(qa.PointToPoint(plant, 0.0, 0.8, start=0.5), [])
    motion = TimedMotion.load(exported([there, back], tmp_path, "m.yaml", pause=0.5, joint="lift"))
    assert motion.joints == ("lift",)
    assert motion.duration == pytest.approx(2.1)
    assert motion.points.max() == pytest.approx(0.5)


@pytest.mark.slow
def test_what_is_left_after_each_is_that_of_the_whole_trajectory(moves, tmp_path):
    """The second rings on from the first: its figure is that of the file judged as it is timed."""
    from quietarm.views.formats.export_format import format_of
    from quietarm.views.formats.formats import write_in

    path = tmp_path / "moves.moveit"
    _, (note,) = write_in(format_of(path), moves, path, {"rate": 100.0, "pause": 0.3})
    whole = qa.ocp.evaluate_as_timed(moves[0].task.plant.robot, path)
    alone = moves[1].candidate.in_full.residual
    assert "2 moves, 108 points in 1.36 s; a controller that joins them by quintics" in note
    assert f"{1e3 * whole.residual:.3g} mm after each, by the whole equations" in note
    assert abs(whole.residual - alone) > 1e-3 * alone
