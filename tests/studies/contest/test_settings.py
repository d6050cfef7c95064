"""Methods that are set to something take part under names of their own."""

import json

import pytest
import quietarm.studies.contest.work as work
from quietarm.metaheuristics.budget.run import search_within
from quietarm.metaheuristics.problems.catalogue import problem_of
from quietarm.studies.contest.asked import Contest
from small_contest import LINE, METHODS, NAME, OTHER, documents

pytestmark = pytest.mark.usefixtures("no_pictures")

SET = "nsga2(crossover=0.5, population=16)"


def contest(methods, **settings):
    return Contest((problem_of(NAME),), methods, 2, 130, settings=settings)


def test_a_setting_is_part_of_the_name_unless_it_is_the_default():
    asked = contest(METHODS, nsga2={"crossover": 0.5, "mutation": 1, "population": 16})
    assert list(asked.entries) == [SET, "vepso"]
    assert {run.entry.name for run in asked.planned.values()} == {SET, "vepso"}
    entry = asked.entries[SET]
    assert (entry.method, entry.settings, entry.population) == ("nsga2", {"crossover": 0.5}, 16)
    assert list(contest(METHODS, nsga2={"crossover": 0.8}).entries) == list(METHODS)


def test_one_seed_is_run_on_all_problems_before_the_next():
    asked = Contest((problem_of(NAME), problem_of(OTHER)), METHODS, 2, 130, seed=4)
    assert list(asked.planned) == [
        f"runs/{problem}/{method}/seed{seed}.json"
        for seed in (4, 5)
        for problem in (NAME, OTHER)
        for method in METHODS
    ]


def test_it_takes_part_beside_the_same_method_without(call, copy):
    given = "--setting nsga2.crossover=0.5 --setting nsga2.population=16"
    code, out, err = call(f"{LINE} {given} --output held")
    assert (code, err) == (0, "")
    assert "(crossover=0.5," in out
    kept = documents(copy)
    assert {method for method, _ in kept} == {*METHODS, SET}
    # exactly what a search with these settings finds
    problem = problem_of(NAME)
    scale = work.Store(copy).yardsticks[NAME].scale
    alone = search_within(
        problem.task, "nsga2", 130, scale, profile=problem.profile, bound=problem.bound,
        population=16, settings={"crossover": 0.5}, seed=1,
    )  # fmt: skip
    points = kept[SET, 1]["front"]["points"]
    assert [tuple(p["coefficients"]) for p in points] == [
        p.coefficients for p in alone.front.points
    ]
    assert points != kept["nsga2", 1]["front"]["points"]
    assert kept[SET, 1]["front"]["settings"]["crossover"] == 0.5
    text = (copy / "contest.html").read_text()
    assert "NSGA-II (crossover=0.5, population=16): bound 0.2" in text
    # the same line again runs nothing
    before = json.dumps(kept[SET, 1])
    assert call(f"{LINE} {given} --output held")[0] == 0
    assert json.dumps(documents(copy)[SET, 1]) == before


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            "crossover=0.5",
            "setting crossover names no method that runs; begin it with",
        ),
        ("gde3.crossover=0.5", "setting gde3.crossover names no method that runs"),
        ("nsga2.crosover=0.5", "nsga2 has no setting 'crosover'; did you mean 'crossover'"),
        ("nsga2.crossover=2", "crossover is 2; give a number from 0 to 1"),
        ("nsga2.population=1", "population is 1"),
    ],
)
def test_settings_that_do_not_fit_are_refused(call, folder, given, words):
    code, out, err = call(f"{LINE} --setting {given} --output new")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert list(folder.iterdir()) == []
