"""Joint profiles on the command line: families of cycloids, and input shapers."""

from lines import MOVE
from quietarm.ocp import (
    CycloidNetwork,
    Plan,
)


def test_a_family_is_planned_evaluated_and_written(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = "--output p.json --csv p.csv --figure p.svg"
    code, out, err = call(f"plan {MOVE} --profile network --terms 4 --starts 1 --quiet {files}")
    assert (code, err) == (0, "")
    found = Plan.load("p.json")
    assert found.profile == CycloidNetwork(4)
    assert found.profile.label in " ".join(out.split())
    numbers = ",".join(map(repr, found.coefficients))
    code, _, err = call(
        f"evaluate {MOVE} --profile network --coefficients={numbers} --quiet --output e.json"
    )
    assert (code, err) == (0, "")
    assert Plan.load("e.json").motion == found.motion


def test_one_shaper_for_each_mode(call):
    code, out, _ = call("evaluate dual-link --target pi/2 --duration 0.9 --profile zv")
    assert code == 0
    assert "zv shaper for 10.64 and 12.59 rad/s: 4 impulses" in " ".join(out.split())
