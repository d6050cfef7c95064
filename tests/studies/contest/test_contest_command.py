"""`quietarm contest`: what it writes and refuses, and how it goes on after a stop."""

import shutil

import pytest
import quietarm.studies.contest.work as work
from quietarm.metaheuristics.budget.run import search_within
from small_contest import LINE, METHODS, NAME, found, rows_of

pytestmark = pytest.mark.usefixtures("no_pictures")


@pytest.fixture
def searches(monkeypatch):
    """The method and seed of every search that is begun."""
    begun = []

    def noted(task, method, evaluations, scale, **settings):
        begun.append((method, settings["seed"]))
        return search_within(task, method, evaluations, scale, **settings)

    monkeypatch.setattr(work, "search_within", noted)
    return begun


def test_every_run_is_a_file_beside_tables_pictures_and_page(held):
    names = {str(path.relative_to(held)) for path in held.rglob("*") if path.is_file()}
    runs = {f"runs/{NAME}/{method}/seed{seed}.json" for method in METHODS for seed in (0, 1)}
    assert runs | {f"exact/{NAME}.json", "contest.html", "tables/runs.csv"} <= names
    assert {f"figures/anytime-{NAME}.png", f"figures/anytime-{NAME}.pdf"} <= names
    assert (held / "contest.html").read_text().startswith("<!DOCTYPE html>")


def test_the_same_line_again_runs_nothing(call, copy, searches):
    before = found(copy)
    code, out, err = call(f"{LINE} --output {copy}")
    assert (code, err, searches) == (0, "", [])
    assert "NSGA-II" in out
    assert found(copy) == before


def test_a_method_and_seeds_are_added_without_the_others_again(call, copy, searches):
    line = LINE.replace("--runs 2", "--runs 3")
    shutil.rmtree(copy / f"runs/{NAME}/vepso")
    assert call(f"{line} --output {copy}")[0] == 0
    assert sorted(searches) == [("nsga2", 2), ("vepso", 0), ("vepso", 1), ("vepso", 2)]
    assert len(rows_of(copy, "runs")) == 6
