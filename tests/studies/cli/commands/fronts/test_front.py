"""`quietarm front`: fronts by the gradient, and fronts of others polished."""

import csv
import math
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from saved_files import edit

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
    polish_front,
    weighted_front,
)
from quietarm.ocp.front.points import LEVELS, non_dominated_rows
from quietarm.views.report.captions import caption_of_front

MOVE = "arm-on-flexible-link --target 90deg --duration 0.8 --terms 3"
TASK, PROFILE = PointToPoint(ArmOnFlexibleLink(), np.pi / 2, 0.8), CycloidPolynomial(3)


def test_an_epsilon_front_is_shown_and_written(call):
    code, out, err = call(
        f"front {MOVE} --points 6 --starts 2 --seed 3 --bound 0.5 --output f.json --output f.svg"
    )
    found = Front.load("f.json")
    assert code == 0
    again = epsilon_front(TASK, PROFILE, bound=0.5, points=6, at=LEVELS, starts=2, seed=3)
    assert found == again
    assert "<svg" in Path("f.svg").read_text()
    lines = out.splitlines()
    iterations = found.record.iterations
    assert lines[0] == f"{caption_of_front(found)}."
    assert lines[1].endswith(f"{found.smallest_residual().energy:.4g} J at rest")
    assert lines[5].split() == ["within", "1", "mm", f"{found.cheapest(1e-3).energy:.4g}", "J"]
    assert lines[7] == "residuals are at the tip within 1.717 s"  # two periods at the target
    assert lines[8].startswith(f"epsilon: 9 points, {iterations} iterations of the solver ")
    assert lines[9:] == ["wrote f.json", "wrote f.svg"]
    assert err.splitlines()[-1] == "9 of 9 points"  # 0.1, 1 and 5 mm as well


@pytest.mark.slow
def test_a_weighted_front_takes_the_weights_that_are_typed(done):
    line = f"front {MOVE} --method weighted --weights 1:1 --weights 1:3 --quiet --output f.json"
    out = done(line)
    assert Front.load("f.json") == weighted_front(TASK, PROFILE, weights=[(1, 1), (1, 3)])
    assert "\nweighted: 4 points, " in out  # the ends and one for each weight


@pytest.mark.slow
def test_the_other_solver_checks_the_front(done):
    out = done(f"front {MOVE} --points 4 --bound 0.5 --check --quiet --output f.json")
    assert Front.load("f.json").record.settings["solver"] == "sqp"
    (shares,) = re.findall(
        r"checked by IPOPT, 7 points .* differ by (\S+) to (\S+) of their size",
        " ".join(out.split()),
    )
    low, high = map(float, shares)
    assert -1e-6 <= low <= high <= 1e-6


# Fronts from files: polished, interpolated, exported


@pytest.fixture(scope="module")
def rough():
    """Points of the front of two terms, used with four: a front that can be improved."""
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8, torque_limit=1.0)
    found = epsilon_front(task, CycloidPolynomial(2), bound=0.5, points=8, starts=1)
    points = tuple(replace(p, coefficients=(*p.coefficients, 0.0, 0.0)) for p in found.points)
    return replace(found, profile=CycloidPolynomial(4), points=points).restated(method="nsga2")


@pytest.mark.slow
def test_a_front_is_polished_shown_and_written(call, rough):
    rough.save("rough.json")
    expected = polish_front(rough)
    files = "--output p.json --output p.csv --output p.svg"
    code, out, err = call(f"front --polish rough.json {files}")
    assert code == 0
    assert Front.load("p.json") == expected.front
    assert err.splitlines()[-1] == "8 of 8 points"
    assert "\nnsga2, polished: 8 points, " in out
    shares = np.array([gain.share for gain in expected.gains])
    assert out.startswith(f"Polishing saves {shares.max():.2%} of the energy of a point at most, ")
    assert shares.max() > 1e-3
    with open("p.csv") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["energy_J"]) for row in rows] == [p.energy for p in expected.front.points]
    assert "<svg" in Path("p.svg").read_text()


def test_motions_between_the_points_of_a_front_are_added_and_written(call, rough):
    """They are of the front's task and box, none is dominated, and the record counts them."""
    rough.restated(bound=0.5, evaluations=100).save("rough.json")
    code, out, err = call("front --interpolate rough.json --output finer.json --output finer.svg")
    assert code == 0, err
    finer = Front.load("finer.json")
    added = [point for point in finer.points if point not in rough.points]
    assert len(added) > len(rough.points)
    assert f"{len(added)} of 294 motions tried between its points were added" in out
    assert finer.record.evaluations == 100 + 294
    assert np.abs(finer.coefficients).max() <= 0.5
    judged = finer.judged(added[len(added) // 2])
    assert judged.energy == pytest.approx(added[len(added) // 2].energy, rel=1e-9)
    for limit in np.linspace(*finer.residuals[[0, -1]], 20)[1:]:
        assert finer.least_energy(limit) <= rough.least_energy(limit)
    table = np.column_stack([finer.residuals, finer.energies])
    assert len(non_dominated_rows(table)) == len(table)
    assert "<svg" in Path("finer.svg").read_text()
    assert call("front --interpolate finer.json --output again.json")[0] == 0
    again = Front.load("again.json").record
    assert again.settings["interpolated"] == again.evaluations - 100  # of both times


def test_what_a_front_is_interpolated_from_is_not_changed_by_options(refused, rough):
    rough.save("rough.json")
    line = "front --interpolate rough.json"
    assert "--bound is not for --interpolate, which keeps the" in refused(f"{line} --bound 1")
    assert "is not for --polish" in refused("front --polish rough.json --interpolate other.json")


def test_the_motion_of_a_front_within_a_residual_is_exported(call, refused, rough):
    """It is the cheapest of those within it, written as its plan is."""
    rough.save("rough.json")
    limit = rough.residuals[3] + 1e-9
    code, _, err = call(f"export rough.json --residual-limit {limit} --output move.csv --rate 200")
    assert code == 0, err
    chosen = rough.cheapest(residual_limit=limit)
    plan = evaluate_coefficients(rough.task, chosen.coefficients, profile=rough.profile)
    plan.save("plan.json")
    assert call("export plan.json --output same.csv --rate 200")[0] == 0
    assert Path("move.csv").read_text() == Path("same.csv").read_text()
    assert "such as --residual-limit 1mm" in refused("export rough.json --output move.st")
    line = "--residual-limit 1mm --output"
    assert "a plan is one motion" in refused(f"export plan.json {line} move.st")
    assert "html shows whole fronts" in refused(f"export rough.json {line} move.html")
    assert "give 0 or more" in refused("export rough.json --residual-limit=-1mm --output move.st")


# A file states figures, which are computed again before they count


@pytest.mark.parametrize("line", ["front --polish f.json", "compare good.json f.json"])
@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        ("points/1/energy", lambda energy: energy / 1.01, "point 2 of 8 states energy 0."),
        ("points/1/coefficients", [0.5, 0.5, 1e308, -1e308], "its coefficients give no finite"),
        ("record/bound", 0.01, "beyond the stated bound of 0.01"),
        ("task/torque_limit", 0.05, "breaks the torque limit of 0.05 N m"),
    ],
)
def test_a_front_with_wrong_figures_is_refused(refused, rough, line, place, value, words):
    rough.restated(bound=None if "finite" in words else 0.5).save("good.json")
    shutil.copy("good.json", "f.json")
    edit("f.json", place, value)
    assert words in refused(line)
