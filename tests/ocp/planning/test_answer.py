"""The answer a person keeps: figures, equality, files to load, tables to drive a joint with."""

import csv
from dataclasses import replace

import numpy as np
import pytest

import quietarm as qa
import quietarm.ocp.judged_motion
from quietarm.ocp import Figures, Verification

# Table 1, N = 2.
TWO_TERMS = [3.347e-3, -1.697e-1]


@pytest.fixture(scope="module")
def plan(tasks):
    """The single link along the paper's two terms."""
    return qa.evaluate_coefficients(tasks["single link"], TWO_TERMS)


@pytest.fixture(params=["single link", "arm", "two links"])
def any_plan(request, tasks, solved):
    return solved(tasks[request.param], 4)


@pytest.mark.parametrize(
    ("energies", "residuals", "agrees"),
    [
        ((1.0009, 1.0), (0.0, 0.0), True),
        ((1.0011, 1.0), (0.0, 0.0), False),
        ((0.9989, 1.0), (0.0, 0.0), False),
        ((1.0, 1.0), (1.1e-6, 0.0), False),
        ((1.0, 1.0), (0.9989e-2, 1e-2), False),
    ],
)
def test_what_counts_as_verified(energies, residuals, agrees):
    motion = Figures({"energy": energies[1], "residual": residuals[1]})
    assert Verification.between(80, energies[0], residuals[0], motion).agrees == agrees


def test_a_saved_plan_loads_equal(any_plan, tmp_path):
    any_plan.save(tmp_path / "plan.json")
    loaded = qa.Plan.load(tmp_path / "plan.json")
    assert loaded == any_plan
    assert (
        loaded.motion
        == qa.JudgedMotion.of_profile(loaded.task, loaded.profile, loaded.coefficients).motion
    )


@pytest.mark.slow
@pytest.mark.parametrize("errors", [{}, {"frequency": 0.04}], ids=["certain", "uncertain"])
def test_what_planning_has_simulated_is_not_simulated_again(tasks, monkeypatch, errors):
    uncertainty = qa.Uncertainty(errors) if errors else None
    task = replace(tasks["single link"], uncertainty=uncertainty)
    planned = qa.plan_move(task, qa.CycloidPolynomial(4), starts=1)
    evaluated = qa.evaluate_coefficients(task, planned.coefficients)

    def refuse(*arguments):
        raise AssertionError("CVODES is asked again")

    monkeypatch.setattr(quietarm.ocp.judged_motion, "integrate", refuse)
    for plan in (planned, evaluated, planned.restated(seconds=1.0)):
        assert (plan.motion.energy, plan.motion.residual) == (plan.energy, plan.residual)
        assert (plan.worst is None) == (not errors)
    assert planned.motion == evaluated.motion
    if errors:
        assert planned.worst.errors == evaluated.worst.errors
        assert planned.worst.residual == evaluated.worst.residual


def _table(plan, path, *rate):
    plan.save_csv(path, *rate)
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    return header, np.array(rows, dtype=float)


@pytest.mark.parametrize(
    ("rate", "rows"),
    # 0.8 s: as many ticks as begin before arrival, and one at or after it.
    [((), 801), ((333.3,), 268), ((0.1,), 2)],
)
def test_a_table_has_a_row_for_every_tick_up_to_arrival(plan, tmp_path, rate, rows):
    _, table = _table(plan, tmp_path / "move.csv", *rate)
    ticks = np.arange(rows) / (rate[0] if rate else 1000.0)
    assert table[:, 0] == pytest.approx(ticks, rel=1e-9)
    assert table[-1, 0] >= 0.8 - 1e-9
    assert table[-2, 0] < 0.8


def test_a_duration_that_is_a_tick_but_for_rounding_ends_at_that_tick(tasks, tmp_path):
    plan = qa.evaluate_coefficients(replace(tasks["arm"], duration=0.1 + 0.2), [])
    assert len(_table(plan, tmp_path / "move.csv", 1000)[1]) == 301


def test_a_table_agrees_with_path_and_trajectory(any_plan, tmp_path):
    _, table = _table(any_plan, tmp_path / "move.csv", 200)
    t, digits = table[:, 0], 1e-9  # ten digits are written
    for order in range(3):
        expected = any_plan.path(t, order)
        close = digits * max(np.abs(expected).max(), 1.0)
        assert table[:, 1 + order] == pytest.approx(expected, abs=close)
    sampled = any_plan.sampled(t)
    tips = sampled.tips.shape[1]
    assert table[:, 4 : 4 + tips] == pytest.approx(sampled.tips, abs=digits)
    assert table[:, 4 + tips] == pytest.approx(sampled.torque, abs=digits)
    assert table[:, 5 + tips] == pytest.approx(sampled.power, abs=digits)
