"""Joint profiles on the command line: families of cycloids, and input shapers."""

import pytest
from lines import MOVE
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidSpline,
    Front,
    Plan,
    PointToPoint,
    ShapedCycloid,
    SolveStatus,
)
from quietarm.ocp.profiles.cycloid import Cycloid
from quietarm.studies.registry.profiles import profile_of


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


FAMILIES = {"gaussians": CycloidGaussians, "network": CycloidNetwork, "spline": CycloidSpline}


@pytest.mark.parametrize("name", FAMILIES)
def test_a_family_is_planned_evaluated_and_written(call, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    files = "--output p.json --csv p.csv --figure p.svg"
    code, out, err = call(f"plan {MOVE} --profile {name} --terms 4 --starts 1 --quiet {files}")
    assert (code, err) == (0, "")
    found = Plan.load("p.json")
    assert found.profile == FAMILIES[name](4)
    assert f"cycloid-{name} of 4 terms" in " ".join(out.split())
    numbers = ",".join(map(repr, found.coefficients))
    code, _, err = call(
        f"evaluate {MOVE} --profile {name} --coefficients={numbers} --quiet --output e.json"
    )
    assert (code, err) == (0, "")
    assert Plan.load("e.json").motion == found.motion


@pytest.mark.parametrize(
    ("name", "terms"), [("polynomial", 6), ("gaussians", 5), ("network", 5), ("spline", 6)]
)
def test_each_family_has_its_own_size_by_default(name, terms):
    task = PointToPoint(SingleLinkManipulator(), target=1.0, duration=1.0)
    profile = profile_of(name, task)
    assert isinstance(profile, Cycloid)
    assert profile.terms == terms


def test_fronts_of_families_are_found_and_compared(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    searched = "--method nsga2 --population 20 --generations 5 --quiet"
    swept = "--method epsilon --points 3 --starts 1 --quiet"
    for line in (
        f"front {MOVE} --profile network --terms 2 {searched} --output network.json",
        f"front {MOVE} --profile gaussians --terms 2 {searched} --output gaussians.json",
        f"front {MOVE} --profile spline --terms 4 {swept} --output spline.json",
    ):
        code, _, err = call(line)
        assert (code, err) == (0, "")
    assert Front.load("network.json").settings["bound"] == CycloidNetwork.default_bound
    code, out, _ = call(
        "compare network.json gaussians.json spline.json --no-floor --output compared"
    )
    assert code == 0
    assert "profile cycloid-network" in " ".join(out.split())


def test_one_shaper_for_each_mode(call):
    code, out, _ = call("evaluate dual-link --target pi/2 --duration 0.9 --profile zv")
    assert code == 0
    assert "zv shaper for 10.64 and 12.59 rad/s: 4 impulses" in " ".join(out.split())


@pytest.mark.parametrize(
    ("line", "status", "says"),
    [
        ("plan single-link --target 1 --duration 0.5 --profile zvd", 2, "0.5 s, too short for the"),
        ("evaluate single-link --target 1 --duration 0.2 --profile zv", 2, "give 0.3171 s or more"),
        (f"plan {MOVE} --profile zv --terms 4", 2, "gaussians, network and spline, not for zv"),
        (f"plan {MOVE} --profile ei --bound 0.2", 2, "and spline, not for ei"),
        (f"plan {MOVE} --profile zv --method vepso", 2, "--method is for polynomial, gaussians"),
        (f"evaluate {MOVE} --profile zv --coefficients=1", 2, "and spline, not for zv"),
        (f"evaluate {MOVE}", 2, "--coefficients"),
        (f"plan {MOVE} --profile zvdd", 2, "unknown profile 'zvdd'; did you mean 'zvd'?"),
        (f"plan {MOVE} --profile network --terms 0", 2, "terms is 0; give 1 to 32"),
        (f"plan {MOVE} --profile spline --terms 1", 2, "terms is 1; give 4 to 32"),
        (f"evaluate {MOVE} --profile gaussians --coefficients=1,2", 2, "give 4, 7, 10"),
        (f"evaluate {MOVE} --profile spline --coefficients=1,2", 2, "got 2 coefficients; cycloid-"),
        (f"evaluate {MOVE} --profile network --coefficients={'0,' * 99}0", 2, "10, ... or 97 numb"),
        (f"evaluate {MOVE} --profile gaussians --coefficients=0,0.1,0,1e5", 2, "4 is 100000, the "),
        (f"front {MOVE} --method epsilon --profile zv", 2, "one motion for a move, and therefore"),
        (f"front {MOVE} --method nsga2 --workers two", 2, "'two' is no whole number; give one"),
        (f"plan {MOVE} --profile network --terms 1e3", 2, "terms is 1000; give 1 to 32"),
        (f"plan {MOVE} --method nsga2 --setting population=20", 2, "as --population 20"),
        (f"front {MOVE} --method nsga2", 2, "give a bound on the coefficients"),
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
