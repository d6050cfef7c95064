"""The problems in the hands of other libraries."""

import json
import random
import re

import pytest
from pages import blocks

from quietarm.metaheuristics import problem_of
from quietarm.ocp import Front

pytestmark = pytest.mark.slow

BLOCKS = blocks("problems", "python") + blocks("own_methods", "python")
(PLATYPUS,), (STEADY,) = (
    [block for block in BLOCKS if name in block] for name in ("platypus", "jmetal")
)


def test_the_pages_examples_run_as_they_stand(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for block in BLOCKS:
        if block not in (PLATYPUS, STEADY):
            exec(compile(block, "page", "exec"), {})
    assert Front.load("random.json").record.method == "random"
    printed = capsys.readouterr().out.splitlines()
    assert any(float(line) > 0 for line in printed if re.fullmatch(r"[\d.]+", line))  # IGD+
    # a method of one's own beside all others: a row of each seed
    rows = [line.split()[1] for line in printed if re.match(r"\d+ ", line)]
    assert [rows.count(name) for name in ("Nearby", "sampling", "moead-de", "epsilon")] == [2] * 4
    assert printed[-1] == "['nsga2', 'sampling']"


def none_beats_the_exact_front(objectives):
    """Check that no objectives are better than those of any motion within the limits."""
    (front,) = problem_of("arm-on-flexible-link-90deg-0.8s-limits").fronts()
    for residual, energy in objectives:
        beyond = [point.energy for point in front.points if point.residual >= residual]
        assert energy >= max(beyond, default=front.cheapest().energy) * (1 - 1e-4)


def test_platypus_searches_a_problem_with_limits():
    pytest.importorskip("platypus")
    random.seed(5)
    names = {}
    exec(compile(PLATYPUS, "page", "exec"), names)
    found = [solution for solution in names["algorithm"].result if solution.feasible]
    assert len(found) > 2
    none_beats_the_exact_front(solution.objectives for solution in found)


def test_a_steady_state_of_jmetal_searches_it_and_is_recorded(tmp_path, monkeypatch):
    pytest.importorskip("jmetal")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(STEADY, "page", "exec"), names)
    found = [one for one in names["algorithm"].result() if min(one.constraints) >= 0]
    assert len(found) > 2
    none_beats_the_exact_front(one.objectives for one in found)
    kept = json.loads((tmp_path / "steady-state.json").read_text())
    assert kept["record"]["evaluations"] == 400  # each child is one
