"""`--robust` of `plan` and `evaluate`: what they find, show and write."""

import pytest
from lines import MOVE, TWO_TERMS

from models import SingleLinkManipulator
from ocp import Front, Plan, UncertainPlant, evaluate_coefficients


def test_a_robust_plan_says_where_it_leaves_most(call):
    code, out, err = call(
        f"plan {MOVE} --robust frequency=4% --starts 1 --output plan.json --figure plan.png --quiet"
    )
    assert (code, err) == (0, "")
    plan = Plan.load("plan.json")
    assert isinstance(plan.task.plant, UncertainPlant)
    assert plan.task.plant.ranges == {"frequency": 0.04}
    assert plan.excess <= 0
    error = 100 * plan.worst.errors["frequency"]
    assert f"{1e3 * plan.worst.residual:.3g} mm with frequency {error:+.3g} %" in out
    assert "single-link, frequency +-4 %, 0 to 30 deg in 0.8 s" in out

    code, out, err = call("robustness plan.json --frequency 4% --samples 10 --quiet")
    assert (code, err) == (0, "")
    ends = [
        line.split()[-1] for line in out.splitlines() if " from [%]" in line or " to [%]" in line
    ]
    assert ends == ["-4", "4"]


def test_given_coefficients_are_evaluated_within_the_errors(call):
    code, out, err = call(
        f"evaluate {MOVE} {TWO_TERMS} --robust zeta=20% --robust omega=5% --output plan.json"
    )
    assert (code, err) == (0, "wrote plan.json\n" if "wrote" in err else err)
    plan = Plan.load("plan.json")
    assert plan.task.plant == UncertainPlant(SingleLinkManipulator(), {"zeta": 0.2, "omega": 0.05})
    assert plan.worst.residual >= plan.residual * (1 - 1e-6)
    assert f"{1e3 * plan.worst.residual:.3g} mm with zeta" in out


@pytest.mark.parametrize("shaper", ["zv"])
def test_a_shaper_is_that_of_the_assumed_plant(call, shaper):
    code, out, err = call(
        f"plan {MOVE} --profile {shaper} --robust frequency=10% --output plan.json --quiet"
    )
    assert (code, err) == (0, "")
    assert "2 impulses" in out
    assert Plan.load("plan.json").excess is None  # no limit was asked for


@pytest.mark.parametrize(
    "method", ["nsga2 --population 8 --generations 2", "epsilon --points 2 --starts 1"]
)
def test_a_front_says_what_its_points_leave_between_the_samples(call, method):
    line = f"front {MOVE} --terms 4 --bound 0.5 --robust frequency=10% --quiet --output f.json"
    code, out, err = call(f"{line} --method {method}")
    assert (code, err) == (0, "")
    front = Front.load("f.json")
    for name in ("stillest", "cheapest"):
        point = getattr(front, name)()
        plan = evaluate_coefficients(front.task, point.coefficients, profile=front.profile)
        (said,) = [line for line in out.splitlines() if line.startswith(f"  {name} ")]
        error = 100 * plan.worst.errors["frequency"]
        assert plan.worst.residual >= point.residual * (1 - 1e-3)
        assert said.endswith(
            f" J at {1e3 * point.residual:.3g} mm; at worst {1e3 * plan.worst.residual:.3g} mm "
            f"with frequency {error:+.3g} %"
        )
