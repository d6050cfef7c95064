"""`--robust` of `plan` and `evaluate`: what they find, show and write."""

import io
import math
from dataclasses import replace

import pytest
from lines import MOVE
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import Plan, PointToPoint, UncertainPlant, evaluate_coefficients
from quietarm.ocp.record import SolveSettings
from quietarm.studies.document.terminal import show
from quietarm.studies.reports.plan import plan_document
from rich.console import Console


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
    (most,) = [line.split()[-1] for line in out.splitlines() if "largest between" in line]
    assert most == f"{1e3 * plan.worst.residual:.3g}"


@pytest.fixture(scope="module")
def cycloid():
    plant = UncertainPlant(SingleLinkManipulator(), {"frequency": 0.1})
    return evaluate_coefficients(PointToPoint(plant, math.pi / 6, 0.8), [])


@pytest.mark.parametrize(
    ("excess", "stopped", "says"),
    [
        (0.2, None, "20.0 % above the limit; not robust enough: more than 5% above; give a larger"),
        (-0.1, None, "10.0 % below the limit"),
    ],
)
def test_a_plan_that_is_not_robust_enough_says_so(cycloid, excess, stopped, says):
    settings = SolveSettings(residual_limit=cycloid.worst.residual / (1 + excess))
    provenance = replace(cycloid.provenance, settings=settings, stopped=stopped)
    text = io.StringIO()
    document = plan_document(replace(cycloid, provenance=provenance))
    show(Console(file=text, width=400), document)
    (row,) = [line.strip() for line in text.getvalue().splitlines() if "at worst" in line]
    assert says in row
    assert ("not robust" in row) == (excess > 0.05)
