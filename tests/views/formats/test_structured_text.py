"""Function blocks in Structured Text, run beside the exported C."""

from ctypes import c_double
from functools import partial
from math import nan, pi

import numpy as np
import pytest
from c_library import compiled, joint_by, needs_compiler
from robots import UR5_JOINTS, straight, ur5_with_bar
from st_interpreter import MATIEC, Block, as_row, needs_matiec, run_by_matiec

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidPolynomial,
    PointToPoint,
    evaluate_coefficients,
    shaped_cycloid,
)
from quietarm.ocp.profiles.joint_spline import JointSpline
from quietarm.views.formats.formats import export_plan

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8, start=-0.2)
AXIS = PointToPoint(LinearAxis(), 0.3, 0.5)
MOVES = {
    "polynomial": (LINK, CycloidPolynomial(6)),
    "zvd": (LINK, shaped_cycloid(LINK, "zvd")),
    "axis": (AXIS, CycloidPolynomial(3)),
    "network": (LINK, CycloidNetwork(5)),
    "gaussians": (LINK, CycloidGaussians(5)),
    "spline": (LINK, JointSpline((0.2, 0.5, 0.8))),
}
STEP = 0.8 / 16


def plan_along(task, profile):
    rng = np.random.default_rng(5)
    coefficients = profile.plain + 0.1 * rng.uniform(-1, 1, profile.size)
    return evaluate_coefficients(task, coefficients, profile=profile)


def block_of(plan, path, **settings):
    """The block of a plan, as it is interpreted."""
    export_plan(plan, path, **settings)
    return Block(path.read_text())


@pytest.mark.slow_after(1)
@needs_compiler
@pytest.mark.parametrize("move", MOVES.values(), ids=MOVES)
def test_a_block_gives_what_the_c_gives_to_the_last_digits(move, tmp_path):
    plan = plan_along(*move)
    block = block_of(plan, tmp_path / "move.st")
    export_plan(plan, tmp_path / "move.c")
    joint = partial(joint_by, compiled(tmp_path / "move.c").move_at)
    duration = plan.task.duration
    steps = np.random.default_rng(1).uniform(0.2, 1.8, 60) * duration / 60
    rows = [as_row(block(Execute=True, TimeStep=step)) for step in steps]
    times = np.concatenate([[0.0], np.cumsum(steps[1:])])
    for time, row in zip(times, rows, strict=True):
        arrived = time >= duration
        assert row[:3] == [not arrived, arrived, False]
        found = joint(c_double(time))
        # the time is summed up in another order: a last digit of it times the speed
        scale = np.abs(plan.sampled(np.linspace(0, duration, 200)).joint).max()
        assert row[3:] == pytest.approx(found, rel=1e-12, abs=1e-13 * max(scale, 1.0))


def test_real_numbers_of_a_small_plc(tmp_path):
    plan = plan_along(LINK, CycloidPolynomial(6))
    block = block_of(plan, tmp_path / "move.st", real="REAL")
    rows = np.array([as_row(block(Execute=True, TimeStep=1e-3))[3:] for _ in range(801)])
    expected = plan.sampled(np.arange(801) / 1000).joint
    # 24 bits, and some tens of operations
    assert (abs(rows - expected).max(axis=0) <= 2e-6 * abs(expected).max(axis=0)).all()
    with pytest.raises(ValueError, match="real is 'DOUBLE'; give LREAL or REAL"):
        export_plan(plan, tmp_path / "other.st", real="DOUBLE")


def test_execute_done_and_error_are_those_of_plcopen(tmp_path):
    plan = plan_along(LINK, CycloidPolynomial(6))
    block = block_of(plan, tmp_path / "move.st")

    def call(execute, step=STEP):
        outputs = block(Execute=execute, TimeStep=step)
        assert sum(outputs[name] for name in ("Busy", "Done", "Error")) <= 1
        state = [name for name in ("Busy", "Done", "Error") if outputs[name]]
        return "".join(state) or "idle", outputs["Position"]

    assert call(False) == ("idle", -0.2)
    assert call(True) == ("Busy", -0.2)
    # what falls or rises again on the way changes nothing
    assert [call(k % 2 == 0)[0] for k in range(15)] == ["Busy"] * 15
    assert call(False) == ("Done", pi / 6)
    assert call(False) == ("idle", pi / 6)
    assert call(True) == ("Busy", -0.2)
    for _ in range(15):
        assert call(True)[0] == "Busy"
    assert [call(True)[0] for _ in range(3)] == ["Done"] * 3
    assert call(False)[0] == "idle"
    for wrong in (0.0, -STEP, nan, 0.9):
        assert call(True)[0] == "Busy"
        middle = [call(True) for _ in range(5)][-1][1]
        outputs = block(Execute=True, TimeStep=wrong)
        assert (outputs["Error"], outputs["Velocity"], outputs["Acceleration"]) == (True, 0, 0)
        assert outputs["Position"] == middle
        assert call(True)[0] == "Error"
        assert call(False)[0] == "idle"


@pytest.mark.slow
def test_a_block_has_all_joints_of_a_robot(tmp_path):
    task = qa.PointToPoint(ur5_with_bar().along(straight()), target=1.0, duration=1.0)
    plan = qa.evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])
    block = block_of(plan, tmp_path / "move.st")
    if MATIEC:
        calls = [(True, 0.04)] * 27
        assert len(run_by_matiec(tmp_path / "move.st", calls, 6)[0]) == 3 + 18
    text = (tmp_path / "move.st").read_text()
    for number, name in enumerate(UR5_JOINTS, 1):
        assert f"(* joint {number}: {name} [rad] *)" in text
    rows = np.array([as_row(block(Execute=True, TimeStep=0.04))[3:] for _ in range(26)])
    joints = plan.sampled(np.arange(26) / 25).sample.joints
    expected = np.column_stack([joint[order] for order in range(3) for joint in joints])
    expected[[0, -1], 6:] = 0  # at rest before and after the move
    assert rows == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())


@pytest.mark.slow
@needs_matiec
@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("move", MOVES.values(), ids=MOVES)
def test_the_compiler_matiec_agrees(move, real, tmp_path):
    plan = plan_along(*move)
    block = block_of(plan, tmp_path / "move.st", real=real)
    step = plan.task.duration / 40
    calls = [(k % 50 > 3, step) for k in range(120)] + [(True, 0.0), (True, step), (False, step)]
    expected = np.array([as_row(block(Execute=run, TimeStep=dt)) for run, dt in calls])
    found = run_by_matiec(tmp_path / "move.st", calls)
    digits = 1e-13 if real == "LREAL" else 3e-6
    assert found == pytest.approx(expected, abs=digits * np.abs(expected).max())


@pytest.mark.parametrize("name", ["2__move", "a-b", "move_", "\u00e9"])
def test_a_name_that_no_block_can_have_is_refused(name, tmp_path):
    plan = plan_along(LINK, CycloidPolynomial(2))
    with pytest.raises(ValueError, match=r"which is no name in IEC 61131-3; give a file name of"):
        export_plan(plan, tmp_path / f"{name}.st")
