"""A joint that moves no mode: nothing ever vibrates, and every command goes on."""

import pytest
from lines import MOVE
from quietarm.ocp import Front, Plan

RIGID = f"{MOVE} --set beta1=0 --quiet"
ENDS = "--bound 0.2 --terms 2 --points 3 --starts 1"


@pytest.fixture
def plan(call):
    assert call(f"plan {RIGID} --terms 2 --starts 1 --output plan.json --figure plan.png")[0] == 0
    return Plan.load("plan.json")


def test_a_plan_is_still(plan):
    assert plan.residual == 0


@pytest.mark.parametrize(
    "method",
    [
        f"epsilon {ENDS}",
        f"weighted {ENDS}",
        f"epsilon {ENDS} --robust frequency=5%",
        "nsga2 --bound 0.2 --terms 2 --population 8 --generations 2",
    ],
)
def test_a_front_is_one_still_motion(call, method):
    code, _, err = call(f"front {RIGID} --method {method} --output front.json --figure front.png")
    assert (code, err) == (0, "")
    (point,) = Front.load("front.json").points
    assert point.residual == 0


@pytest.mark.usefixtures("plan")
def test_its_robustness_is_drawn(call, folder):
    code, out, err = call("robustness plan.json --samples 20 --quiet --output found")
    assert (code, err) == (0, "")
    assert "wrote found/robustness.png" in out
    assert (folder / "found" / "robustness.png").exists()


def test_a_share_of_nothing_is_no_limit(call):
    line = f"plan {RIGID} --terms 2 --starts 1 --robust frequency=5%"
    code, _, err = call(line)
    assert code == 2
    assert err.startswith("quietarm: the plain cycloid does not bend this plant")
    assert err.endswith("give a residual limit above 0\n")
    assert call(f"{line} --residual-limit 1mm")[0] == 0
