"""The arms of `benchmarks/simulator.py`, drawn ones, and a post with two ways past it."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "docs" / "results")]

import quietarm as qa  # noqa: E402

pytestmark = pytest.mark.slow
mujoco = pytest.importorskip("mujoco")

import simulator  # noqa: E402
from parts.simulated_arm import ARMS, drawn  # noqa: E402
from recomputing.basins import read  # noqa: E402


def test_objectives_are_those_of_one_step_after_another_with_the_servo_in_python():
    """The model without its servo, which is written anew as forces on the motor."""
    arm = drawn()[0]
    row = np.random.default_rng(0).uniform(-0.1, 0.1, arm.terms)
    model, data = arm.model, mujoco.MjData(arm.model)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
    there = 0.4 * np.array([np.cos(arm.target), np.sin(arm.target), 0.0])
    energy, off = 0.0, 0.0
    sent = qa.motion_of(arm.task, arm.profile, row, step=1e-3, after=0.4)
    for time, angle, speed, _ in zip(*sent, strict=True):
        servo = arm.machine.servo_stiffness * (angle - data.qpos[0])
        torque = servo + arm.machine.servo_damping * (speed - data.qvel[0])
        data.qfrc_applied[0] = torque
        mujoco.mj_step(model, data)
        if time < arm.duration:
            energy += 1e-3 * abs(torque * data.qvel[0])
        else:
            off = max(off, np.linalg.norm(data.site("end").xpos - there))
    model.opt.disableflags = 0
    ((residual, of_arm),) = arm(row[None])
    assert residual == pytest.approx(off, rel=0.02)  # the servo's damping is implicit there
    assert of_arm == pytest.approx(energy, rel=0.06)


def test_drawn_arms_keep_the_rule():
    arms = drawn()
    assert [arm.post is not None for arm in arms] == [False] * 5 + [True] * 5
    assert sorted(arm.terms for arm in arms) == [4] * 5 + [8] * 5
    for arm in arms:
        plain = arm(np.zeros((1, arm.terms)))
        objectives, violations = plain if arm.post else (plain, np.ones((1, 1)))
        assert 2e-3 <= objectives[0, 0] <= 0.2
        assert violations[0, 0] > 0  # the plain cycloid hits the post
        assert 15 <= np.degrees(arm.target) <= 60


def test_an_arm_passes_the_post_before_it_or_after_it():
    *_, arm = ARMS
    rows = np.random.default_rng(0).uniform(arm.lower, arm.upper, (60, 4))
    rows[0] = 0.0
    _, violations = arm(rows)
    clear = violations[:, 0] <= 0
    assert not clear[0]  # the plain cycloid hits it
    before = np.array([arm.passes_early(row) for row in rows])
    assert clear[before].sum() > 10
    assert clear[~before].sum() > 10


def test_a_run_is_a_row_and_is_not_run_again(tmp_path, monkeypatch):
    monkeypatch.setattr(simulator, "METHODS", ("random",))
    monkeypatch.setattr(simulator, "ARMS", ARMS[2:])
    monkeypatch.setattr(simulator, "BUDGET", 20)
    monkeypatch.setattr(simulator, "LONG", 20)
    monkeypatch.setattr(simulator, "outside", lambda: ())
    table = tmp_path / "black_box.csv"
    simulator.run_three(1, (), tmp_path)
    content = table.read_text()
    rows = list(csv.DictReader(content.splitlines()))
    assert [(row["method"], row["seed"]) for row in rows] == [("moead-de", "100"), ("random", "0")]
    for row in rows:
        residuals, energies = row["residuals_mm"].split(), row["energies_mJ"].split()
        assert len(residuals) == len(energies) > 0
    simulator.run_three(1, (), tmp_path)
    assert table.read_text() == content


def test_runs_of_drawn_arms_are_packed_and_not_run_again(tmp_path, monkeypatch):
    monkeypatch.setattr(simulator, "METHODS", ("random",))
    monkeypatch.setattr(simulator, "drawn", lambda: ARMS[2:])
    monkeypatch.setattr(simulator, "BUDGET", 20)
    monkeypatch.setattr(simulator, "LONG", 20)
    monkeypatch.setattr(simulator, "LONGEST", 30)
    monkeypatch.setattr(simulator, "outside", lambda: ())
    for _ in range(2):
        simulator.PLANS["drawn"](1, (), tmp_path)
        runs = read(tmp_path / "arms.csv.xz")
        assert [(run.method, run.candidates, run.seed) for run in runs] == [
            ("moead-de", 20, 100), ("moead-de", 30, 100), ("random", 20, 0),
        ]  # fmt: skip
        assert all(len(run.points) for run in runs)
