"""`quietarm plan` by a metaheuristic."""

import math
from pathlib import Path

import pytest
import quietarm.studies.runs.searching
from quietarm.metaheuristics import search
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Plan, PointToPoint

MOVE = "single-link --target 30deg --duration 0.8 --bound 0.2 --terms 2"
TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


# quietarm plan


@pytest.fixture
def quick(monkeypatch):
    """A search in place of the paper's."""

    def small(task, method, **settings):
        return search(task, method, population=20, generations=30, **settings)

    monkeypatch.setattr(quietarm.studies.runs.searching, "search", small)


def test_a_plan_by_search_is_the_cheapest_point_within_the_limit(call, quick):
    line = f"plan {MOVE} --method vepso --quiet"
    code, out, err = call(f"{line} --residual-limit 2mm --output plan.json")
    assert (code, err) == (0, "")
    front = search(
        TASK,
        "vepso",
        profile=CycloidPolynomial(2),
        bound=0.2,
        population=20,
        generations=30,
        seed=0,
    )
    point = front.cheapest(2e-3)
    assert Plan.load("plan.json").coefficients == point.coefficients
    assert "residual limit 0 stands for" not in out


def test_a_plan_by_search_says_what_a_limit_of_zero_stands_for(call, quick):
    _, out, err = call(f"plan {MOVE} --method vepso --output plan.json")
    assert "residual limit 0 stands for 1 mm here: no search arrives exactly at rest" in out
    assert err.startswith("generation 30/30, ")
    _, out, _ = call(f"plan {MOVE} --method vepso --polish --output polished.json")
    assert "stands for" not in out
    assert Plan.load("polished.json").residual < 1e-8 < Plan.load("plan.json").residual <= 1e-3


def test_an_interrupted_search_makes_no_plan_and_says_what_keeps_it(call, quick, interrupted_at):
    interrupted_at(3)
    code, out, err = call(f"plan {MOVE} --method vepso --quiet --output plan.json")
    assert (code, out, Path("plan.json").exists()) == (1, "", False)
    assert "nothing was written; `quietarm front` keeps what a search has found" in err
