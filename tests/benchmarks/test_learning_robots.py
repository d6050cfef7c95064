"""Learning of robots' plans in MuJoCo: benchmarks/learning_robots.py in a shortened form."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))


@pytest.mark.slow
def test_one_move_tells_a_wrong_frequency_beside_a_gear_that_the_model_lacks(monkeypatch):
    pytest.importorskip("mujoco")
    import learning_robots

    monkeypatch.setattr(learning_robots, "AFTER", 1.5)  # less to simulate
    case = learning_robots.Case("ur5", -0.1, "gear", "acceleration")

    before, after = learning_robots.course(case, moves=1)

    left = 5  # column of what a move leaves [mm]
    assert float(before[left]) == pytest.approx(10.1, abs=0.1)  # of the wrong model, in MuJoCo
    assert float(after[left]) < float(before[left]) / 10
    assert float(after[left]) < float(after[left + 1])  # what was said of it
