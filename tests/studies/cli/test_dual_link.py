"""Every command on a plant of two modes and two tips, with cheap settings."""

import csv
import math
from dataclasses import replace
from functools import partial

import pytest
import quietarm.studies.study.pieces
from quietarm.models import DualLinkManipulator
from quietarm.ocp import Front, Plan, PointToPoint, energy_floor

MOVE = "dual-link --target pi/2 --duration 0.9"
TASK = PointToPoint(DualLinkManipulator(), math.pi / 2, 0.9)
SMALL = "--population 12 --generations 4"


@pytest.fixture
def done(call, tmp_path, monkeypatch):
    """Run a line that must succeed in an empty folder: its standard output."""
    monkeypatch.chdir(tmp_path)

    def run(line):
        code, out, err = call(line)
        assert code == 0, err
        return out

    return run


def test_plan(done, tmp_path):
    out = done(f"plan {MOVE} --starts 1 --output plan.json --csv move.csv --figure move.svg")
    assert "at the worst of 2 tips" in out
    found = Plan.load(tmp_path / "plan.json")
    assert found.task == TASK
    assert found.residual < 1e-8
    assert found.energy == pytest.approx(0.27983, abs=1e-5)  # docs/physics.md, 'A third plant'
    with open(tmp_path / "move.csv", newline="") as file:
        assert next(csv.reader(file))[4:6] == ["tip_1_m", "tip_2_m"]
    picture = (tmp_path / "move.svg").read_text()
    assert "this plan" in picture
    assert "this plan, tip 2" in picture


def test_evaluate(done):
    out = done(f"evaluate {MOVE} --coefficients=0")
    assert "0.777437 J" in out  # docs/physics.md: 0.77744 J, 158.2 mm
    assert "158 mm" in out


@pytest.mark.parametrize("method", ["epsilon", "weighted"])
def test_front_by_gradient(done, tmp_path, method):
    done(f"front {MOVE} --method {method} --terms 5 --points 3 --starts 1 --output f.json")
    front = Front.load(tmp_path / "f.json")
    assert front.task == TASK
    assert front.stillest().residual < 1e-8


@pytest.mark.parametrize("method", ["nsga2", "vepso"])
def test_front_by_search_polished_and_compared(done, tmp_path, method):
    done(f"front {MOVE} --method {method} --bound 0.5 --terms 5 {SMALL} --output f.json --quiet")
    done("polish f.json --points 2 --output polished.json --figure polished.png")
    found, polished = Front.load(tmp_path / "f.json"), Front.load(tmp_path / "polished.json")
    assert polished.cheapest().energy < found.cheapest().energy
    out = done("compare f.json polished.json --no-floor --output compared")
    assert "dual-link, 0 to 90 deg in 0.9 s" in out


def test_floor(done, tmp_path):
    # Limited in acceleration, the floor is found on coarser grids, above that of docs/physics.md.
    out = done(
        f"floor {MOVE} --acceleration-limit 60 --starts 1 --tolerance 0.1 --output floor.json"
    )
    assert "at the worst of 2 tips" in out
    assert (tmp_path / "floor.json").exists()


def test_study(done, tmp_path, monkeypatch):
    quick = partial(energy_floor, starts=1, tolerance=0.1)  # a floor is found in a test above
    monkeypatch.setattr(quietarm.studies.study.pieces, "energy_floor", quick)
    done(
        f"study {MOVE} --acceleration-limit 60 --bound 0.5 --terms 5 --points 3 --runs 1 {SMALL} "
        "--method nsga2 --output s.html --fronts fronts --quiet"
    )
    assert "dual-link" in (tmp_path / "s.html").read_text()
    fronts = [Front.load(path) for path in (tmp_path / "fronts").iterdir()]
    assert len(fronts) >= 4
    assert {front.task for front in fronts} == {replace(TASK, acceleration_limit=60.0)}


def test_help_names_the_plant(call):
    assert "dual-link" in call("--help")[1]
