"""The problems of a contest: the named ones, with the exact fronts that come with them."""

import pytest
from quietarm.metaheuristics import PROBLEMS
from quietarm.studies.contest.store import Store, Yardstick, problems_of
from quietarm.studies.reproduce.paper import CONDITIONS
from small_contest import LINE, NAME, documents, rows_of

pytestmark = pytest.mark.usefixtures("no_pictures")

LIMITS, THIRD = "single-link-30deg-0.8s-limits", "single-link-30deg-0.8s-torque"


def test_without_a_name_they_are_the_papers_conditions():
    found = problems_of(())
    assert [problem.task for problem in found] == [case.task for case in CONDITIONS]
    assert [problem.bound for problem in found] == [case.bound for case in CONDITIONS]
    assert {problem.profile.size for problem in found} == {6}
    assert problems_of((NAME, NAME)) == (PROBLEMS[NAME],)
    assert {problem.name for problem in problems_of(("all",))} == PROBLEMS.keys() - {THIRD}


def test_the_yardstick_is_the_front_that_comes_with_the_problem(held):
    found = Store(held).yardsticks[NAME]
    assert (found.front,) == PROBLEMS[NAME].fronts()
    assert found == Yardstick.of(PROBLEMS[NAME])


def test_a_method_without_limits_is_left_out_where_there_are_some(call, folder):
    line = LINE.replace("vepso", "moead").replace("--runs 2", "--runs 1")
    code, out, err = call(f"{line.replace(NAME, f'{NAME} {LIMITS}')} --output held")
    assert (code, err) == (0, "")
    words = f"moead cannot search {LIMITS}, which has limits: it is left out there"
    assert words in out
    assert words in (folder / "held/contest.html").read_text()
    assert set(documents(folder / "held")) == {("nsga2", 0), ("moead", 0)}
    assert set(documents(folder / "held", LIMITS)) == {("nsga2", 0)}
    assert [(row["problem"], row["method"]) for row in rows_of(folder / "held", "runs")] == [
        (NAME, "moead"), (NAME, "nsga2"), (LIMITS, "nsga2"),
    ]  # fmt: skip
