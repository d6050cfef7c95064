"""`--robust` of `plan` and `evaluate`: what they find, show and write."""

from lines import MOVE
from quietarm.ocp import Plan


def test_a_robust_plan_says_where_it_leaves_most(call):
    code, out, err = call(
        f"plan {MOVE} --robust frequency=4% --starts 1 --output plan.json --figure plan.png --quiet"
    )
    assert (code, err) == (0, "")
    plan = Plan.load("plan.json")
    assert plan.task.ranges == {"frequency": 0.04}
    assert plan.excess <= 0
    error = 100 * plan.worst.errors["frequency"]
    assert f"{1e3 * plan.worst.residual:.3g} mm with frequency {error:+.3g} %" in out
    assert "single-link, frequency +-4 %, 0 to 30 deg in 0.8 s" in out

    code, out, err = call("robustness plan.json --frequency 4% --samples 10 --quiet")
    assert (code, err) == (0, "")
    (most,) = [line.split()[-1] for line in out.splitlines() if "largest between" in line]
    assert most == f"{1e3 * plan.worst.residual:.3g}"
