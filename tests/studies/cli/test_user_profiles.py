"""A profile of a user's own, in one file: the one of docs/extend.md, through four commands."""

from pathlib import Path

import pytest
from pages import shown_file

from quietarm.ocp import Front, Plan

pytestmark = pytest.mark.usefixtures("what_is_made_up_is_forgotten")

PROFILE = shown_file("extend", "minimum_jerk.py")
MOVE = "--target 60deg --duration 3 --profile minimum-jerk --quiet"
LEAST_JERK_SPEED = 15 / 8
"""Largest speed of the motion of least jerk over the mean: 30 s^2 (1 - s)^2 at s = 1/2."""


def lines(move):
    """Four commands that make a plan, a front, a front of a search, and a plan of coefficients."""
    return [
        f"plan {move} --terms 4 --output plan.json",
        f"front {move} --terms 4 --points 3 --output front.json",
        f"search {move} --terms 4 --bound 1 --population 20 --generations 3 --output search.json",
        f"evaluate {move} --coefficients=0,0,0 --output least.json",
    ]


def check_answers(span, duration):
    """All four files have the profile; the motion without coefficients is that of least jerk."""
    plan = Plan.load("plan.json")
    front = Front.load("front.json")
    found = Front.load("search.json")
    least = Plan.load("least.json")
    labels = [answer.profile.label for answer in (plan, front, found, least)]
    assert labels == [f"minimum-jerk of {terms} terms" for terms in (4, 4, 4, 3)]
    assert plan.residual < 1e-8
    assert front.points
    assert found.points
    expected = LEAST_JERK_SPEED * span / duration
    assert least.motion.peak_speed == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow  # of a profile alone: tests/recipes
def test_a_profile_beside_a_plant_in_the_plant_file(done, call, refused, crane_file):
    crane_file.write_text(f"{crane_file.read_text()}\n\n{PROFILE}")
    for line in lines(f"{MOVE} --plant-file crane.py"):
        done(line)
    check_answers(span=3.141592653589793 / 3, duration=3)
    polish = "front --polish search.json --plant-file crane.py --quiet --output polished.json"
    assert call(polish)[0] == 0
    assert Front.load("polished.json").profile == Front.load("search.json").profile
    told = refused(f"evaluate --plant-file crane.py {MOVE.replace('jerk', 'jrk')} --coefficients=1")
    assert "did you mean 'minimum-jerk'" in told


EXITS = """

class Leaves(qa.TermProfile):
    name = "leaves"

    def angle(self, coefficients, fraction):
        raise SystemExit("enough")
"""


def test_a_profile_that_ends_the_process_is_an_error_with_its_line(refused, crane_file):
    crane_file.write_text(f"{crane_file.read_text()}\n\n{PROFILE}{EXITS}")
    line = len(crane_file.read_text().splitlines())
    move = "--target 60deg --duration 3 --profile leaves"
    told = refused(f"plan --plant-file crane.py {move}")
    assert f"crane.py, line {line}: it calls sys.exit(enough), which would end quietarm" in told


@pytest.mark.slow
def test_workers_know_the_profile_of_a_plant_file(call, crane_file):
    crane_file.write_text(f"{crane_file.read_text()}\n\n{PROFILE}")
    line = f"search --plant-file crane.py {MOVE} --terms 3 --bound 1 --population 20"
    line += " --generations 2 --runs 2 --workers 2 --output found.json"
    code, _, err = call(line)
    assert (code, err) == (0, "")
    saved = sorted(Path().glob("found*.json"))
    assert len(saved) == 2
    assert {Front.load(file).profile.amount for file in saved} == {"3 terms"}
