"""`quietarm compare`: what it shows, what it writes, what it refuses."""

import csv
import dataclasses

import pytest
import quietarm.studies.comparison.measures
import quietarm.studies.reading.saved
import quietarm.studies.reports.comparison
from quietarm.ocp import FrontPoint, evaluate_coefficients

# The fronts are invented, not motions of the plant: nothing can be evaluated between their points.
FILES = ("report.md", "runs.csv", "coverage.csv", "fronts.png")


@pytest.fixture
def files(good, poor, tmp_path, monkeypatch):
    """Two files, in the folder of the test."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(quietarm.studies.reading.saved, "check_figures", lambda front, name: None)
    good.save("good.json")
    poor.save("poor.json")
    return tmp_path


# The command


def test_compare_fills_a_folder(call, files, good, poor):
    code, out, _ = call("compare good.json poor.json --as-found --no-floor --output compared")
    assert code == 0
    assert out.splitlines()[-4:] == [f"wrote compared/{name}" for name in FILES]
    assert {path.name for path in (files / "compared").iterdir()} == set(FILES)
    report = (files / "compared" / "report.md").read_text()
    assert "![Fronts](fronts.png)" in report
    rows = list(csv.reader((files / "compared" / "coverage.csv").read_text().splitlines()))
    # all of `poor` is beaten by `good`, and none of `good` by `poor`
    assert rows[1:] == [["by epsilon constraint", "", "100.0"], ["by NSGA-II", "0.0", ""]]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("t_s,theta_rad\n0,0\n", "is not a front: it is not whole, valid JSON"),
        (
            '{"format": "quietarm-plan", "version": 1}',
            "its format is 'quietarm-plan'; give a front file",
        ),
        (
            '{"format": "quietarm-front", "version": 2}',
            "this quietarm reads 3; find the front again",
        ),
    ],
)
def test_what_is_no_front_is_refused_in_a_line(call, files, content, words):
    if content is not None:
        (files / "bad.json").write_text(content)
    code, out, err = call("compare good.json bad.json")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "bad.json" in err
    assert words in err


@pytest.fixture
def moved(task):
    """Three motions of the plant, with the figures that CVODES gives them."""
    points = []
    for a in (0.0, 0.02, 0.04):
        plan = evaluate_coefficients(task, [a, 0.0])
        points.append(FrontPoint((a, 0.0), plan.residual, plan.energy))
    return points


@pytest.mark.parametrize(
    ("change", "words"),
    [({"energy": 0.002}, "states energy 0.002 J, but its coefficients give 0.0")],
)
def test_edited_figures_are_refused_in_a_line(call, front_of, moved, tmp_path, change, words):
    edited = dataclasses.replace(moved[1], **change)
    of_points(front_of, moved[:1]).save(tmp_path / "a.json")
    of_points(front_of, [edited]).save(tmp_path / "b.json")
    code, out, err = call(f"compare {tmp_path / 'a.json'} {tmp_path / 'b.json'} --no-floor")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"b.json: point 1 of 1 {words}" in err


def of_points(front_of, points):
    return dataclasses.replace(front_of([(1, 1)]), points=tuple(points))
