"""Moves of robots for controllers, in pictures and in films: every joint by its name."""

import csv
import ctypes
from ctypes import c_double
from functools import lru_cache
from itertools import pairwise
from math import inf, nan

import numpy as np
import pytest
import yaml
from c_library import compiled, needs_compiler
from PIL import Image
from robots import BAR, END, START, UR5_JOINTS, straight, ur5_with_bar, urdf_of
from saved_figures import saved_figures
from scipy.io import loadmat

import quietarm as qa
from quietarm.views import animate
from quietarm.views.formats.between_rows import interpolation_note, residual_between
from quietarm.views.formats.csv_rows import CsvRows
from quietarm.views.formats.formats import export_plan
from quietarm.views.pictures import Line
from quietarm.views.pictures.structure import structures_of

LIMIT = {"elbow_joint": 25.0}


def csv_text(plan, columns, rate):
    """A table as text."""
    return CsvRows().content(plan, columns=columns, rate=rate)


@lru_cache
def _plan(path=None):
    task = qa.PointToPoint(
        ur5_with_bar().along(path or straight()), target=1.0, duration=1.0, torque_limit=LIMIT
    )
    return qa.evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])


def _curved():
    middle = (START + END) / 2 + 0.1
    return qa.GeometricPath.through([START, middle, END], joints=UR5_JOINTS)


@pytest.mark.slow_after(1)
@needs_compiler
@pytest.mark.parametrize("path", [None, _curved()], ids=["straight", "curved"])
def test_c_gives_all_joints_at_any_time(path, tmp_path):
    plan = _plan(path)
    export_plan(plan, tmp_path / "move.c")
    library = compiled(tmp_path / "move.c")
    names = (ctypes.c_char_p * 6).in_dll(library, "move_joints")
    assert tuple(name.decode() for name in names) == UR5_JOINTS

    def joints(time):
        values = [(c_double * 6)() for _ in range(3)]
        library.move_at(c_double(time), *values)
        return np.array([list(row) for row in values])

    times = np.sort(np.random.default_rng(1).uniform(0, 1.0, 100))
    sample = plan.sampled(times).sample
    for order in range(3):
        expected = np.array([joint[order] for joint in sample.joints])
        found = np.array([joints(time)[order] for time in times]).T
        assert found == pytest.approx(expected, abs=1e-12 * max(1.0, np.abs(expected).max()))
    nothing = np.zeros((2, 6))
    for time, positions in ((-1.0, START), (nan, START), (5.0, END), (inf, END)):
        assert joints(time) == pytest.approx(np.vstack([positions, nothing]), abs=1e-12)


@pytest.mark.slow
def test_ros_has_all_joints_at_the_controllers_rate(tmp_path):
    plan = _plan(_curved())
    export_plan(plan, tmp_path / "move.yaml", rate=125)
    message = yaml.safe_load((tmp_path / "move.yaml").read_text())
    assert tuple(message["joint_names"]) == UR5_JOINTS
    assert len(message["points"]) == 126
    joints = plan.sampled(np.arange(126) / 125).sample.joints
    names = ("positions", "velocities", "accelerations")
    for order, name in enumerate(names):
        found = np.array([point[name] for point in message["points"]])
        expected = np.column_stack([joint[order] for joint in joints])
        assert found == pytest.approx(expected, abs=1e-9)


def test_tables_have_a_column_for_each_joint(tmp_path):
    plan = _plan()
    columns = "time:ms,angle:deg,speed,acceleration,torque,tip:mm"
    export_plan(plan, tmp_path / "move.csv", columns=columns, rate=10)
    export_plan(plan, tmp_path / "move.mat", columns=columns, rate=10)
    with (tmp_path / "move.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    matlab = loadmat(tmp_path / "move.mat")
    sample = plan.sampled(np.arange(11) / 10).sample
    for joint, motion, torque in zip(UR5_JOINTS, sample.joints, sample.torques, strict=True):
        for name, values in (
            (f"{joint}_angle_deg", np.degrees(motion.angle)),
            (f"{joint}_speed_rad_s", motion.speed),
            (f"{joint}_torque_Nm", torque),
        ):
            assert [float(row[name]) for row in rows] == pytest.approx(values, abs=1e-7)
            assert matlab[name].ravel() == pytest.approx(values, abs=1e-7)


@pytest.mark.slow
def test_a_rate_of_a_controller_is_not_called_coarse():
    """The place on the path is interpolated, in whatever unit the joints are."""
    for plan in (_plan(), _plan(_curved())):
        assert interpolation_note(plan, 500) == ""
        assert residual_between(plan, 500, 3) == pytest.approx(plan.residual, rel=1e-4)


@pytest.mark.slow
def test_joints_stand_above_each_other_with_their_limits():
    figure = qa.motion_figure(_plan())
    drawn = [ax for ax in figure.axes if ax.lines]
    # angle, speed, acceleration and torque of six joints, and two directions of the tip
    assert len(drawn) == 6 * 4 + 2
    assert [ax.get_ylabel().replace("\n", "_") for ax in drawn if ax.get_ylabel()] == [*UR5_JOINTS]
    limited = [line for ax in drawn for line in ax.lines if line.get_label() == "limit"]
    assert [list(line.get_ydata()) for line in limited] == [[-25.0, -25.0]]
    (legend,) = [ax.get_legend() for ax in figure.axes if ax.get_legend()]
    words = [text.get_text() for text in legend.get_texts()]
    assert words == ["plain cycloid", "this plan", "limit"]
    assert "along its path in 1 s" in figure.get_suptitle().replace("\n", " ")


@pytest.mark.slow
def test_the_film_shows_the_robot_where_pinocchio_says(tmp_path):
    """Still, the drawn tip is the end of the bar, hanging by its sag."""
    pinocchio = pytest.importorskip("pinocchio")
    plan = _plan()
    (structure,) = structures_of([Line(plan, "plan")], np.array([0.0, 1.0]), 2.0, 1.0)
    model = pinocchio.buildModelFromUrdf(str(urdf_of("ur5_robot.urdf")))
    data = model.createData()
    ends = []
    for q in (START, END):
        pinocchio.framesForwardKinematics(model, data, q)
        pose = data.oMf[model.getFrameId("tool0")]
        along = np.array([0.0, 0.0, BAR["length"]])
        sag = ur5_with_bar().sag(q)
        ends.append(pose.translation + pose.rotation @ (along + sag))
    (path,) = structure.paths
    # on arrival it still swings
    assert path == pytest.approx(np.array(ends), abs=1e-4 + 1.5 * np.abs(structure.tips).max())
    assert np.abs(structure.tips).max() < 0.01


def test_displacements_of_the_tip_are_named_by_the_axes_of_its_frame(tmp_path):
    """The bar lies along z of its link: it bends along x and y."""
    header = csv_text(_plan(), "time,tip:mm", 100.0).splitlines()[0]
    assert header == "time_s,tip_x_mm,tip_y_mm"
    _plan().save_csv(tmp_path / "move.csv")
    assert ",tip_x_m,tip_y_m," in (tmp_path / "move.csv").read_text().splitlines()[0]


@pytest.mark.slow
def test_a_film_of_a_robot_moves_and_has_the_cycloid_beside_it(tmp_path):
    film = animate(_plan(), width=240, rate=3)
    with saved_figures() as figures:
        film.save(tmp_path / "film.gif")
    (legend,) = figures[-1].legends
    words = [text.get_text() for text in legend.get_texts()]
    assert words[:2] == ["plain cycloid", "this plan"]
    assert words[2:4] == ["without bending", "way of the tip"]
    assert words[4:] == ["robot", "support", "squares of 20 cm"]
    assert [structure.line.label for structure in film.structures] == ["plain cycloid", "this plan"]
    with Image.open(tmp_path / "film.gif") as image:
        assert image.n_frames == 7
        frames = []
        for number in range(3):
            image.seek(number)
            frames.append(np.asarray(image.convert("RGB")).astype(int))
    assert all(np.abs(after - before).sum() > 0 for before, after in pairwise(frames))
