"""The problems in the hands of other libraries."""

import random
import re
from pathlib import Path

import pytest
from quietarm.metaheuristics import problem_of
from quietarm.ocp import Front

DOCUMENT = Path(__file__).parents[3] / "docs" / "problems.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```$", DOCUMENT.read_text(), re.DOTALL | re.MULTILINE)
(PLATYPUS,) = [block for block in BLOCKS if "platypus" in block]


def test_the_document_s_examples_run_as_they_stand(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for block in BLOCKS:
        if block != PLATYPUS:
            exec(compile(block, str(DOCUMENT), "exec"), {})
    assert Front.load("random.json").method == "random"
    printed = capsys.readouterr().out.splitlines()
    assert any(float(line) > 0 for line in printed if re.fullmatch(r"[\d.]+", line))  # IGD+
    assert printed[-1] == "['NSGA-II', 'sampling']"


def test_platypus_searches_a_problem_with_limits():
    pytest.importorskip("platypus")
    random.seed(5)
    names = {}
    exec(compile(PLATYPUS, str(DOCUMENT), "exec"), names)
    found = [solution for solution in names["algorithm"].result if solution.feasible]
    assert len(found) > 2
    (front,) = problem_of("arm-on-flexible-link-90deg-0.8s-limits").fronts()
    for residual, energy in (solution.objectives for solution in found):
        beyond = [point.energy for point in front.points if point.residual >= residual]
        assert energy >= max(beyond, default=front.cheapest().energy) * (1 - 1e-4)
