"""`quietarm floor`: what it says, what it writes, what it refuses."""

import re

import pytest
from quietarm.ocp import Floor, FloorSettings
from quietarm.studies.reports.floor import plan_beside

MOVE = "arm-on-flexible-link --target pi/2 --duration 0.8"


@pytest.fixture
def call(call, monkeypatch):
    """Run a line in this process, with lines wide enough for every figure."""
    monkeypatch.setenv("COLUMNS", "200")
    return call


def test_it_prints_the_floor_and_writes_it(call, tmp_path):
    code, out, err = call(
        f"floor {MOVE} --acceleration-limit 100 --starts 2 --seed 3 --tolerance 0.2 "
        f"--output {tmp_path / 'f.json'} --figure {tmp_path / 'f.png'}"
    )
    assert (code, err) == (0, "")
    floor = Floor.load(tmp_path / "f.json")
    assert floor.task.acceleration_limit == 100.0
    assert floor.provenance.settings == FloorSettings(smooth=False, starts=2, seed=3, tolerance=0.2)
    shown = dict(re.findall(r"^(\S+(?: \S+)*)  +(\S.*?) *$", out, re.MULTILINE))
    assert float(shown["least energy"].split()[0]) == pytest.approx(floor.energy, rel=1e-5)
    assert shown["starts"].startswith(f"{floor.agreeing()} of 2")
    left = re.search(r"about (\S+) J \((\S+)%\)", shown["left"])
    assert float(left[1]) == pytest.approx(floor.left, rel=0.06)
    assert shown["plan, 6 terms"].startswith(f"{plan_beside(floor).energy:.6g} J")
    assert (tmp_path / "f.png").read_bytes().startswith(b"\x89PNG")
