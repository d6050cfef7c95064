"""Methods of pymoo by name, and their settings, in `front`, `plan` and `study`."""

import math

from lines import MOVE
from quietarm.metaheuristics import search
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
FRONT = f"front {MOVE} --bound 0.2 --terms 2"
SMALL = {"population": 8, "generations": 4}
SMALL_WORDS = "--population 8 --generations 4 --quiet"


def directly(method, **settings):
    return search(TASK, method, profile=CycloidPolynomial(2), bound=0.2, **SMALL, **settings)


def test_a_front_by_any_method_with_settings(call):
    line = f"{FRONT} --method rvea --setting alpha=3 --setting crossover=0.5 {SMALL_WORDS}"
    code, out, err = call(f"{line} --output f.json --figure f.png")
    assert (code, err) == (0, "")
    assert out.startswith("rvea, seed 0: ")
    wanted = directly("rvea", settings={"alpha": 3, "crossover": 0.5})
    assert Front.load("f.json") == wanted != directly("rvea")
