"""`quietarm study`: what it writes, shows and refuses."""

import pytest
import quietarm.studies.study.work as study_module
from quietarm.ocp import Front
from quietarm.studies.study.findings import case_findings
from quietarm.studies.study.work import Study
from small_study import QUICK

# The command


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of the test's own, and standing in it; lines are not wrapped."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    return tmp_path


MOVE = "study single-link --target 30deg --duration 0.8"


def test_study_writes_the_page_and_the_fronts(call, folder, small, monkeypatch):
    asked = {}

    def at_once(cases, settings, begin):
        asked.update(cases=cases, settings=settings)
        return Study(settings, small.cases[:1], 1.0)

    monkeypatch.setattr(study_module, "run_study", at_once)
    code, out, err = call(
        f"{MOVE} --bound 0.3 --terms 2 --points 3 --runs 2 --population 12 --generations 8 "
        "--fronts fronts --quiet"
    )
    assert (code, err) == (0, "")
    assert asked["settings"] == QUICK
    assert [case.bound for case in asked["cases"]] == [0.3]
    for line in case_findings(small.cases[0]):
        assert f"- {line}" in out
    assert out.splitlines()[-2:] == ["wrote study.html", "wrote 8 fronts to fronts"]
    assert (folder / "study.html").read_text().startswith("<!DOCTYPE html>")
    runs = small.cases[0].comparison.runs
    saved = [Front.load(path) for path in (folder / "fronts").iterdir()]
    assert len(saved) == len(runs) == 8
    assert all(run.front in saved for run in runs)
