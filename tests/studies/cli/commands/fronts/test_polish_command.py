"""`quietarm polish`: a saved front improved, shown, drawn and written."""

import csv
import json
import math
import re
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import quietarm.studies.cli.commands.polish
import quietarm.studies.reading.saved
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


def rows(out):
    """Residual [mm], energies [J] and share [%] of the table."""
    return re.findall(r"^ +(\S+) mm +(\S+) J +(\S+) J +(\S+)%$", out, re.MULTILINE)


def test_a_front_is_polished_shown_and_written(call, rough):
    expected = polish_front(rough)
    code, out, err = call("polish f.json --output p.json --csv p.csv --figure p.svg")
    assert code == 0
    assert Front.load("p.json") == expected.front
    assert err.splitlines()[-1] == "12 of 12 points"
    assert out.startswith("nsga2, polished: 12 points, ")
    shown = rows(out)
    assert len(shown) == 10
    for row, gain in zip((shown[0], shown[-1]), (expected.gains[0], expected.gains[-1]),
                         strict=True):  # fmt: skip
        assert row == (f"{gain.residual * 1e3:.3g}", f"{gain.before:.4g}", f"{gain.after:.4g}",
                       f"{gain.share * 100:.2f}")  # fmt: skip
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


def test_ctrl_c_keeps_what_was_polished(call, monkeypatch):
    def interrupted(front, report, **rest):
        def hear(done, total):
            report(done, total)
            if done == 3:
                signal.raise_signal(signal.SIGINT)

        return polish_front(front, report=hear, **rest)

    monkeypatch.setattr(quietarm.studies.cli.commands.polish, "polish_front", interrupted)
    code, out, err = call("polish f.json --quiet --output p.json --csv p.csv --figure p.png")
    assert (code, err) == (1, "quietarm: interrupted; what was found until then is kept\n")
    assert "(interrupted after 3 of them)" in out
    assert len(rows(out)) == 3
    assert len(Path("p.csv").read_text().splitlines()) == 1 + 3
    assert not Front.load("p.json").complete


def without(**changes):
    """A document of a front with these entries changed."""
    return json.dumps({**json.loads(Path("f.json").read_text()), **changes})


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        (lambda: "{}", "", "bad.json is not a front"),
        (lambda: without(task={"plant": "crane"}), "", "crane"),
        (lambda: without(points=[]), "", "bad.json: the front has no point"),
        (without, "--points 1", "points is 1; give a whole number from 2 up"),
        (without, "--output ./bad.json", "are both bad.json; give two files"),
    ],
)
def test_bad_input_is_refused_in_one_line(call, folder, content, line, words):
    Path("bad.json").write_text(content())
    code, out, err = call(f"polish bad.json {line}")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert sorted(path.name for path in folder.iterdir()) == ["bad.json", "f.json"]
