"""The arm of `benchmarks/simulator.py`: the page's arm, and a post with two ways past it."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
from pages import blocks

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

import quietarm as qa  # noqa: E402

pytestmark = pytest.mark.slow
pytest.importorskip("mujoco")

import simulator  # noqa: E402
from parts.simulated_arm import ANGLE, ARMS  # noqa: E402


def test_the_arm_is_that_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (model,) = blocks("simulators", "xml")
    Path("arm.xml").write_text(model)
    (page,) = (block for block in blocks("simulators", "python") if "mujoco" in block)
    names = {}
    exec(compile(page.partition("lower, upper")[0], "page", "exec"), names)
    free, _, _ = ARMS
    row = np.zeros(4)
    (residual, energy), (too_near,) = names["arm"](row)
    assert too_near < 0  # the plain cycloid misses the page's post, which ours has not
    ((ours, of_ours),) = free(row[None])
    assert ours == pytest.approx(residual, rel=1e-9)
    assert of_ours == pytest.approx(energy, rel=1e-9)


def test_an_arm_passes_the_post_before_it_or_after_it():
    *_, arm = ARMS
    rows = np.random.default_rng(0).uniform(*arm.box, (60, 4))
    rows[0] = 0.0
    _, violations = arm(rows)
    clear = violations[:, 0] <= 0
    assert not clear[0]  # the plain cycloid hits it
    times = []
    for row in rows:
        time, angle, *_ = qa.motion_of(arm.task, arm.profile, row, step=1e-3, after=0.0)
        times.append(time[np.argmax(angle > ANGLE)])
    before = np.array(times) < 0.4
    assert clear[before].sum() > 10
    assert clear[~before].sum() > 10


def test_a_run_is_a_row_and_is_not_run_again(tmp_path, monkeypatch):
    monkeypatch.setattr(simulator, "METHODS", ("random",))
    monkeypatch.setattr(simulator, "ARMS", ARMS[2:])
    monkeypatch.setattr(simulator, "BUDGET", 20)
    monkeypatch.setattr(simulator, "LONG", 20)
    monkeypatch.setattr(simulator, "has_optuna", lambda: False)
    table = tmp_path / "black_box.csv"
    simulator.run(1, table)
    content = table.read_text()
    rows = list(csv.DictReader(content.splitlines()))
    assert [(row["method"], row["seed"]) for row in rows] == [("moead-de", "100"), ("random", "0")]
    for row in rows:
        residuals, energies = row["residuals_mm"].split(), row["energies_mJ"].split()
        assert len(residuals) == len(energies) > 0
    simulator.run(1, table)
    assert table.read_text() == content
