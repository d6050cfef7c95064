"""`quietarm evaluate --path`: the path that another tool or a recorder wrote."""

import re

import numpy as np
import pytest
from lines import MOVE, run
from quietarm.ocp import Plan
from quietarm.studies.export.formats import export_plan


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A plan, and its path at 200 points a second."""
    folder = tmp_path_factory.mktemp("paths")
    run(f"plan {MOVE} --output {folder}/plan.json --quiet")
    plan = Plan.load(folder / "plan.json")
    export_plan(plan, folder / "path.csv", columns="time:ms,angle:deg,torque", rate=200)
    return folder


def test_an_exported_plan_comes_back_as_it_was(call, folder):
    plan = Plan.load(folder / "plan.json")
    code, out, err = call(f"evaluate single-link --path {folder}/path.csv")
    assert (code, err) == (0, "")
    assert re.search(r"single-link, 0 to 30 deg in 0.8 s", out)
    energy = float(re.search(r"energy \(F2\) +([0-9.]+) J", out)[1])
    assert energy == pytest.approx(plan.energy, rel=1e-4)
    assert "at rest (below 0.001 mm)" in out
    assert "161 points, 5 ms apart" in out


def changed(folder, change):
    """The path's columns after a change, in a file."""
    table = np.genfromtxt(folder / "path.csv", delimiter=",", names=True)
    time, angle = change(table["time_ms"].copy(), table["angle_deg"].copy())
    rows = "".join(f"{t},{a}\n" for t, a in zip(time, angle, strict=True))
    (folder / "changed.csv").write_text(f"time_ms,angle_deg\n{rows}")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, a: (t, a + 10 * (t > 400)), "the angle jumps by"),
        (lambda t, a: (t[::-1], a), "the time does not increase from row"),
        (lambda t, a: (t, 1000 * a), r"an angle of 5\d\d(\.\d+)? rad; is it in degrees"),
        (lambda t, a: (t[:3], a[:3]), "has 3 rows; give 5 to 5000"),
        (lambda t, a: (t, np.where(t == 400, np.nan, a)), "a number that is not finite"),
    ],
)
def test_a_path_that_cannot_be_is_refused(call, folder, change, words):
    changed(folder, change)
    code, out, err = call(f"evaluate single-link --path {folder}/changed.csv")
    assert (code, out) == (2, "")
    assert re.search(words, err)
