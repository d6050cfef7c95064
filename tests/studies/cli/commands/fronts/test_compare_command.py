"""`quietarm compare`: what it shows, what it writes, what it refuses."""

import csv

import pytest
import quietarm.studies.comparison.measures
import quietarm.studies.reading.saved
import quietarm.studies.reports.comparison

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
