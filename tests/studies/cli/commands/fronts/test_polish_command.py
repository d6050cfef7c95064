"""`quietarm polish`: a saved front improved, shown, drawn and written."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    PointToPoint,
    epsilon_front,
    polish_front,
)


@pytest.fixture(scope="module")
def rough():
    """Points of the front of two terms, used with four: a front that can be improved."""
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
    found = epsilon_front(task, CycloidPolynomial(2), bound=0.5, points=12, starts=1)
    points = tuple(replace(p, coefficients=(*p.coefficients, 0.0, 0.0)) for p in found.points)
    return replace(found, profile=CycloidPolynomial(4), points=points, method="nsga2")


@pytest.fixture(autouse=True)
def folder(folder, rough):
    rough.save("f.json")
    return folder


def test_a_front_is_polished_shown_and_written(call, rough):
    expected = polish_front(rough)
    code, out, err = call("polish f.json --output p.json --csv p.csv --figure p.svg")
    assert code == 0
    assert Front.load("p.json") == expected.front
    assert err.splitlines()[-1] == "12 of 12 points"
    assert out.startswith("nsga2, polished: 12 points, ")
    shares = np.array([gain.share for gain in expected.gains])
    assert (
        f"saved: median {np.median(shares):.2%}, least {shares.min():.2%}, most {shares.max():.2%}"
    ) in out
    assert shares.max() > 1e-3
    with open("p.csv") as file:
        table = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    assert table == [[g.residual, g.before, g.after, g.share] for g in expected.gains]
    assert "<svg" in Path("p.svg").read_text()
    assert out.splitlines()[-3:] == ["wrote p.json", "wrote p.csv", "wrote p.svg"]
