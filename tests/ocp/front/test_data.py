"""Fronts as data: columns, tables, and fronts of coefficients that were found elsewhere."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from quietarm.ocp import CycloidPolynomial, Front, JudgedMotion, Record

ROWS = np.array([[0.0, 0.0], [0.003347, -0.1697], [0.02, 0.05], [-0.05, -0.2]])


@pytest.fixture(scope="module")
def task(tasks):
    return tasks["single link"]


@pytest.fixture(scope="module")
def given(task):
    return Front.from_coefficients(task, ROWS, method="a swarm", bound=0.2, seed=3)


def by_cvodes(task, rows):
    """(residual, energy) of every row by the independent integrator."""
    motions = [JudgedMotion.of_profile(task, CycloidPolynomial(2), row).motion for row in rows]
    return {tuple(row): (m.residual, m.energy) for row, m in zip(rows, motions, strict=True)}


def test_coefficients_become_a_front_of_those_that_none_beats(task, given):
    figures = by_cvodes(task, ROWS)
    expected = [
        (row, f)
        for row, f in figures.items()
        if not any(g[0] <= f[0] and g[1] <= f[1] and g != f for g in figures.values())
    ]
    expected.sort(key=lambda one: one[1])
    assert 1 < len(expected) < len(ROWS)
    found = [(p.coefficients, (p.residual, p.energy)) for p in given.points]
    assert found == expected
    assert given.record == Record("a swarm", {}, 0.2, 3, 4)
    assert (given.failed, given.infeasible) == (0, 0)


@pytest.mark.parametrize("bound", [-1.0, 0.0, np.nan, 1e7])
def test_a_record_has_a_bound_that_a_file_takes(bound):
    with pytest.raises(ValueError, match="bound on the coefficients is"):
        Record("a swarm", bound=bound)


def test_motions_that_break_a_limit_or_overflow_are_left_out_and_counted(task):
    figures = by_cvodes(task, ROWS)
    torques = [
        JudgedMotion.of_profile(task, CycloidPolynomial(2), row).motion.peak_torque for row in ROWS
    ]
    most = np.median(torques)
    limited = replace(task, torque_limit=most)
    rows = [*ROWS, [1e300, 1e300]]
    front = Front.from_coefficients(limited, rows, method="mine")
    assert (front.record.evaluations, front.infeasible, front.failed) == (5, 2, 1)
    kept = {
        tuple(row) for row, torque in zip(ROWS, torques, strict=True) if torque < np.median(torques)
    }
    assert {point.coefficients for point in front.points} <= kept
    assert all((p.residual, p.energy) == figures[p.coefficients] for p in front.points)


def test_a_front_is_saved_as_a_table_with_every_digit(given, tmp_path):
    given.save_csv(tmp_path / "f.csv")
    with open(tmp_path / "f.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == list(given.columns())
    found = [[float(cell) for cell in row] for row in rows]
    window = given.task.residual_window
    assert found == [[p.residual, p.energy, *p.coefficients, window] for p in given.points]
