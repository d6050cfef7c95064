"""Joint profiles on the command line: families of cycloids, and input shapers."""

import pytest
from lines import MOVE
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidSpline,
    Front,
    Plan,
)

FAMILIES = {"gaussians": CycloidGaussians, "network": CycloidNetwork, "spline": CycloidSpline}


@pytest.mark.parametrize("name", FAMILIES)
def test_a_family_is_planned_evaluated_and_written(call, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    files = "--output p.json --csv p.csv --figure p.svg"
    code, out, err = call(f"plan {MOVE} --profile {name} --terms 4 --starts 1 --quiet {files}")
    assert (code, err) == (0, "")
    found = Plan.load("p.json")
    assert found.profile == FAMILIES[name](4)
    assert found.profile.label in " ".join(out.split())
    numbers = ",".join(map(repr, found.coefficients))
    code, _, err = call(
        f"evaluate {MOVE} --profile {name} --coefficients={numbers} --quiet --output e.json"
    )
    assert (code, err) == (0, "")
    assert Plan.load("e.json").motion == found.motion


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
