"""Ring-downs of robots in MuJoCo: benchmarks/identifying_robots.py in a shortened form."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))


@pytest.fixture
def benchmark(monkeypatch):
    """The benchmark with less to simulate."""
    pytest.importorskip("mujoco")
    import identifying_robots

    monkeypatch.setattr(identifying_robots, "SECONDS", 3.0)
    monkeypatch.setattr(identifying_robots, "PIECES", 5)
    return identifying_robots


@pytest.mark.slow
def test_torques_tell_the_springs_and_the_load_of_a_bar(benchmark):
    row = dict(
        zip(benchmark.COLUMNS, benchmark.row_of(benchmark.Case("ur5", "torques", 1, 1.2, 1.1)))
    )
    assert float(row["frequency_off"]) < 5e-4  # against MuJoCo's own, linearised
    assert float(row["damping_off"]) < 0.05
    assert float(row["stiffness_low"]) < 1.2 < float(row["stiffness_high"])
    assert float(row["payload_low"]) < 0.55 < float(row["payload_high"])
    assert row["payload_by"] == "torques at rest"


@pytest.mark.slow
def test_an_accelerometer_tells_both_where_gears_bend_as_well(benchmark):
    case = benchmark.Case("panda", "acceleration", 1, 0.8, 0.8)
    row = dict(zip(benchmark.COLUMNS, benchmark.row_of(case)))
    assert float(row["frequency_off"]) < 1e-3
    assert float(row["told_stiffness"]) == pytest.approx(0.8, rel=0.01)
    assert float(row["told_payload_kg"]) == pytest.approx(0.32, rel=0.02)  # of 0.4 in the file
    assert row["payload_by"] == "frequencies"
