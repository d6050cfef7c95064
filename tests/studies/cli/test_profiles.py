"""Input shapers on the command line."""

import pytest

from ocp import Plan, ShapedCycloid, SolveStatus

MOVE = "single-link --target 30deg --duration 0.8"


@pytest.mark.parametrize("shaper", ["zv", "zvd", "ei"])
@pytest.mark.parametrize("command", ["plan", "evaluate"])
def test_a_shaped_move_is_evaluated_and_written(call, tmp_path, monkeypatch, command, shaper):
    monkeypatch.chdir(tmp_path)
    code, out, err = call(
        f"{command} {MOVE} --profile {shaper} --output p.json --csv p.csv --figure p.svg"
    )
    assert (code, err) == (0, "")
    found = Plan.load("p.json")
    assert isinstance(found.profile, ShapedCycloid)
    assert found.profile.shaper == shaper
    assert found.status is SolveStatus.NOT_OPTIMISED
    assert f"{shaper} shaper for 10.43 rad/s" in " ".join(out.split())
    assert f"{found.energy:.6g} J" in out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["p.csv", "p.json", "p.svg"]


def test_one_shaper_for_each_mode(call):
    code, out, _ = call("evaluate dual-link --target pi/2 --duration 0.9 --profile zv")
    assert code == 0
    assert "zv shaper for 10.64 and 12.59 rad/s: 4 impulses" in " ".join(out.split())


@pytest.mark.parametrize(
    ("line", "status", "says"),
    [
        ("plan single-link --target 1 --duration 0.5 --profile zvd", 2, "0.5 s, too short for the"),
        ("evaluate single-link --target 1 --duration 0.2 --profile zv", 2, "give 0.3171 s or more"),
        (f"plan {MOVE} --profile zv --terms 4", 2, "--terms is for polynomial, not for zv"),
        (f"plan {MOVE} --profile ei --bound 0.2", 2, "--bound is for polynomial, not for ei"),
        (f"plan {MOVE} --profile zv --method vepso", 2, "--method is for polynomial"),
        (f"evaluate {MOVE} --profile zv --coefficients=1", 2, "--coefficients is for polynomial"),
        (f"evaluate {MOVE}", 2, "--coefficients"),
        (f"plan {MOVE} --profile zvdd", 2, "zvd"),
        (f"plan {MOVE} --profile zv --torque-limit 0.01", 1, "its torque reaches"),
        (f"plan {MOVE} --profile zv --jerk-limit 1", 1, "rad/s^3, above 1"),
        (f"plan {MOVE} --profile zv --residual-limit 1um", 1, "its residual reaches"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(call, line, status, says):
    code, out, err = call(line)
    assert (code, out) == (status, "")
    assert says in err
    assert err.count("\n") == 1
