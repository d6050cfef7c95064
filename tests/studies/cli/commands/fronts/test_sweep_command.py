"""`quietarm front` by the gradient: whole runs of a small size, and what is refused."""

import re
from pathlib import Path

import numpy as np
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    PointToPoint,
    epsilon_front,
    weighted_front,
)
from quietarm.ocp.front.points import LEVELS

MOVE = "arm-on-flexible-link --target 90deg --duration 0.8 --terms 3"
TASK, PROFILE = PointToPoint(ArmOnFlexibleLink(), np.pi / 2, 0.8), CycloidPolynomial(3)


# What is found


def test_an_epsilon_front_is_shown_and_written(call):
    code, out, err = call(
        f"front {MOVE} --method epsilon --points 6 --starts 2 --seed 3 --bound 0.5 "
        "--output f.json --figure f.svg"
    )
    found = Front.load("f.json")
    assert code == 0
    again = epsilon_front(TASK, PROFILE, bound=0.5, points=6, at=LEVELS, starts=2, seed=3)
    assert found == again
    assert "<svg" in Path("f.svg").read_text()
    lines = out.splitlines()
    assert lines[0].startswith(f"epsilon: 9 points, {found.iterations} iterations of the solver ")
    assert lines[1].endswith(f"{found.stillest().energy:.4g} J at rest")
    assert lines[5].split() == ["within", "1", "mm", f"{found.cheapest(1e-3).energy:.4g}", "J"]
    assert lines[7:] == ["wrote f.json", "wrote f.svg"]
    assert err.splitlines()[-1] == "9 of 9 points"  # 0.1, 1 and 5 mm as well


def test_a_weighted_front_takes_the_weights_that_are_typed(call):
    line = f"front {MOVE} --method weighted --weights 1:1 --weights 1:3 --quiet --output f.json"
    code, out, err = call(line)
    assert (code, err) == (0, "")
    assert Front.load("f.json") == weighted_front(TASK, PROFILE, weights=[(1, 1), (1, 3)])
    assert out.startswith("weighted: 4 points, ")  # the ends and one for each weight


def test_the_other_solver_checks_the_front(call):
    line = f"front {MOVE} --method epsilon --points 4 --bound 0.5 --solver sqp --check --quiet"
    code, out, err = call(f"{line} --output f.json")
    assert (code, err) == (0, "")
    assert Front.load("f.json").settings["solver"] == "sqp"
    (shares,) = re.findall(
        r"^checked by IPOPT, 7 points from the plain cycloid: "
        r"its energies differ by (\S+) to (\S+) of their size$",
        out,
        re.MULTILINE,
    )
    low, high = map(float, shares)
    assert -1e-6 <= low <= high <= 1e-6


def test_ctrl_c_ends_a_front_and_writes_nothing(folder, at_a_terminal, ctrl_c):
    # far more points than are found before the signal comes
    line = f"front {MOVE} --method epsilon --points 10000 --output f.json --figure f.png"
    process = at_a_terminal(line)
    found = 0
    while found < 2:  # the ends of the front
        found, *_ = map(int, re.findall(r"\d+", process.stderr.readline()))
    out, err = ctrl_c(process)
    assert (process.returncode, out) == (1, "")
    assert err.splitlines()[-1] == "quietarm: interrupted; what was written until then is kept"
    assert not list(folder.glob("f.*"))


# The picture
