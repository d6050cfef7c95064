"""The problems of docs/results by name, and what a light installation of them needs."""

import pickle
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from quietarm.metaheuristics import Job, drawn_problems, problem_of
from quietarm.metaheuristics.problems import drawn_moves

ROOT = Path(__file__).parents[3]
RESULTS = ROOT / "docs" / "results"
LIMITED = "single-link-m4-6-absolute-torque-tight"


@pytest.mark.parametrize("name", ["moves.csv", "limits.csv"])
def test_the_tables_are_those_that_were_published(name):
    assert (drawn_moves.TABLES / name).read_bytes() == (RESULTS / name).read_bytes()


def test_names_are_those_of_the_published_scales():
    """All problems that were run but those with an own energy, an integer, profile or range."""
    rows = (RESULTS / "scales.csv").read_text().splitlines()[1:]
    published = {row.partition(",")[0] for row in rows}
    of_its_own = ("stages", "motor-map", "integer", "shaper", "robust", "spline", "gaussians")
    left_out = {name for name in published if name.endswith(of_its_own)}
    assert published - left_out <= set(drawn_problems())
    assert len(drawn_problems()) == 210  # 18 moves by 6 coefficients and 4 limits; 10 by 3 more


@pytest.mark.slow
def test_a_drawn_problem_is_a_problem_as_any_other():
    problem = problem_of(LIMITED)
    assert pickle.loads(pickle.dumps(problem)) == problem
    objectives, violations = problem.function()(np.zeros((1, 6)))
    assert objectives.shape == (1, 2)
    # docs/results/limits.csv: a torque limit of 0.7236 N m
    (limit,) = problem.task.limits
    assert limit.upper == pytest.approx(0.723574986)
    assert violations.shape == (1, 1)
    front = Job(problem.name, "random", budget=50).run()
    assert front.record.settings["problem"] == LIMITED


@pytest.mark.slow
def test_its_reference_front_has_the_ends_of_the_published_scale():
    problem = problem_of("linear-axis-m4-2-absolute")
    rows = (RESULTS / "scales.csv").read_text().splitlines()
    row = next(row for row in rows if row.startswith(f"{problem.name},")).split(",")
    scale = problem.reference()
    # of more points than the quick front of the scale
    assert [*scale.ideal, *scale.nadir] == pytest.approx(list(map(float, row[1:5])), rel=0.02)


BLOCKED = """
import sys


class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked}:
            raise ModuleNotFoundError(f"{{name}} is not installed", name=name)


sys.meta_path.insert(0, Blocked())
import numpy as np
from quietarm.metaheuristics import drawn_problems, problem_of

for name in ("{name}", "single-link-30deg-0.8s"):
    problem = problem_of(name)
    print(problem.function()(np.zeros((1, 6)))[0].shape)
print(len(problem.front().points) > 200)
from quietarm.__main__ import main

main()
"""


def light_group():
    """The packages of the dependency group, without versions."""
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text())["dependency-groups"]
    return [re.match(r"[\w-]+", entry)[0] for entry in groups["problems"]]


@pytest.mark.slow
def test_the_problems_need_no_more_than_their_group():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    every = [re.match(r"[\w-]+", entry)[0] for entry in project["dependencies"]]
    light = light_group()
    assert set(light) < set(every)
    imports = {"markdown-it-py": "markdown_it"}
    blocked = sorted(imports.get(name, name) for name in set(every) - set(light))
    script = BLOCKED.format(blocked=blocked, name=LIMITED)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "(1, 2)\n(1, 2)\nTrue\n")
    assert done.stderr.startswith("quietarm: the command needs click, and this is a light install")
    assert done.stderr.count("\n") == 1


def test_the_page_installs_the_group():
    text = (ROOT / "docs" / "problems.md").read_text()
    line = next(line for line in text.splitlines() if "casadi" in line and "pip install" in line)
    assert line.split("install ")[1].split() == light_group()
