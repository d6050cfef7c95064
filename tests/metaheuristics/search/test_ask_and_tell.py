"""Hardware in the loop: a search that is asked and told, and goes on after a kill."""

import dataclasses
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import quietarm as qa
from quietarm.metaheuristics import search_state
from quietarm.ocp.json_text import texts_of

SCRIPT = """
import os, signal, sys
import quietarm as qa

def measure(x):
    return [x[0] ** 2 + x[1] ** 2, (x[0] - 2) ** 2 + x[1] ** 2], [x[0] - 1]

state, method, killed = sys.argv[1], sys.argv[2], int(sys.argv[3])
search = qa.Search(
    [-5, -5], 5, evaluations=45, algorithm=method, constraints=["wall"], state=state, seed=3
)
told = 0
while (candidate := search.ask()) is not None:
    search.tell(candidate, *measure(candidate))
    told += 1
    if told == killed:
        os.kill(os.getpid(), signal.SIGKILL)
search.front().save(sys.argv[4])
"""


def measure(x):
    return [x[0] ** 2 + x[1] ** 2, (x[0] - 2) ** 2 + x[1] ** 2], [x[0] - 1]


def search_of(method="es", evaluations=45, **more):
    options = {"constraints": ["wall"], "seed": 3, "upper": 5} | more
    return qa.Search([-5, -5], evaluations=evaluations, algorithm=method, **options)


def run(search):
    while (candidate := search.ask()) is not None:
        search.tell(candidate, *measure(candidate))
    return search.front()


@pytest.mark.slow  # three processes
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_killed_process_goes_on_to_the_answer_of_an_uninterrupted_one(tmp_path):
    state, end = tmp_path / "run.json", tmp_path / "front.json"
    folder = Path(qa.__file__).parents[1]
    line = [sys.executable, "-c", SCRIPT, str(state), "nsga2"]
    for killed in (17, 0):
        ended = subprocess.run([*line, str(killed), str(end)], cwd=folder, check=False)
        assert ended.returncode == (-signal.SIGKILL if killed else 0)
        assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
    assert qa.Front.load(end) == run(search_of("nsga2"))


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("method", ["es", "nsga2", "slsqp", "mo-cma-es"])
def test_it_goes_on_in_the_middle_of_a_generation_and_asks_what_a_search_asks(method, tmp_path):
    state = tmp_path / "run.json"
    for count in (1, 13):  # abandoned twice
        begun = search_of(method, state=state)
        for _ in range(count):
            candidate = begun.ask()
            begun.tell(candidate, *measure(candidate))
        begun.close()
    continued = search_of(method, state=state)
    assert continued.evaluations == 14
    whole = run(continued)
    assert continued.done
    assert whole == run(search_of(method))

    def measured(x):
        return measure(x)

    direct = qa.search(
        measured, lower=[-5, -5], upper=5, evaluations=45, algorithm=method,
        constraints=["wall"], seed=3,
    )  # fmt: skip
    assert dataclasses.replace(direct, function=whole.function) == whole


def test_a_told_candidate_is_encoded_once_however_often_the_state_is_written(tmp_path, monkeypatch):
    encoded = []

    def counted(document, **more):
        encoded.append(document["number"])
        return texts_of(document, **more)

    monkeypatch.setattr(search_state, "texts_of", counted)
    state = tmp_path / "run.json"
    run(search_of(state=state))
    assert encoded == list(range(1, 46))
    loaded = search_state.SearchState.load(state)  # which checks the checksum
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text() == state.read_text()


def test_several_candidates_may_be_measured_side_by_side_in_any_order():
    together = search_of("nsga2")
    while len(rows := together.ask(4)):
        assert len(rows) <= 4
        rows = rows[::-1]
        values = [measure(row) for row in rows]
        together.tell(rows, [value for value, _ in values], [broken for _, broken in values])
    assert together.front() == run(search_of("nsga2"))


def test_a_candidate_is_asked_for_until_it_is_told_and_failures_are_counted():
    search = search_of("nsga2")
    assert search.ask().tolist() == search.ask().tolist()
    first = search.ask()
    search.tell(first, [np.nan, np.inf], [0.0])
    assert search.ask().tolist() != first.tolist()
    while (candidate := search.ask()) is not None:
        search.tell(candidate, *measure(candidate))
    assert search.front().failed == 1


@pytest.mark.parametrize("method", ["es", "nsga2"])
def test_a_machine_that_fails_at_first_is_mended_and_the_search_goes_on(method, tmp_path):
    state = tmp_path / "run.json"
    failing = search_of(method, state=state)
    for _ in range(19):
        failing.tell(failing.ask(), np.nan)
    with pytest.warns(UserWarning, match=r"all 20 candidates .* have failed; .*run.json keeps"):
        failing.tell(failing.ask(), np.nan)
    failing.tell(failing.ask(), np.nan)  # said once
    failing.close()
    mended = search_of(method, state=state)
    assert mended.evaluations == 21
    front = run(mended)
    assert front.failed == 21
    assert front.points


def test_a_closed_search_is_asked_and_told_nothing():
    closed = search_of()
    first, *others = closed.ask(9)
    closed.tell(first, *measure(first))
    closed.close()
    # the last of these would hand all of them over to a method that has ended, and wait for ever
    for ask_or_tell in (closed.ask, lambda: closed.tell(others, [[1.0, 2.0]] * len(others))):
        with pytest.raises(ValueError, match="the search is closed"):
            ask_or_tell()


def test_violations_where_there_are_no_constraints_are_refused():
    free = qa.Search([-5, -5], 5, evaluations=10, algorithm="es")
    with pytest.raises(ValueError, match="the search has no violations; leave them out"):
        free.tell(free.ask(), [1.0, 2.0], [0.5])
    with pytest.raises(ValueError, match=r"name the violations .* by constraints=\[...\]"):
        free.tell(free.ask(), ([1.0, 2.0], [0.5]))
    free.tell(free.ask(2), ((1.0, 2.0), (3.0, 4.0)))  # a row for each is no pair


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (([9.0, 9.0], [1.0, 1.0], [0.0]), "was not asked for"),
        ((None, [1.0], [0.0]), "objectives have shape"),
        ((None, [1.0, 2.0], None), "violations are missing"),
        ((None, ["one", 2.0], [0.0]), "objectives are"),
        ((None, ([1.0, 2.0], [0.0]), None), r"such as tell\(candidate, \*measure\(candidate\)\)"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(told, words):
    search = search_of()
    candidate, objectives, violations = told
    candidate = search.ask() if candidate is None else candidate
    with pytest.raises(ValueError, match=words) as refused:
        search.tell(candidate, objectives, violations)
    assert "\n" not in str(refused.value)
    search.tell(search.ask(), *measure(search.ask()))  # and it goes on


@pytest.mark.parametrize("method", ["es", "nsga2"])
def test_a_finished_search_goes_on_with_more_evaluations(method, tmp_path):
    state = tmp_path / "run.json"
    run(search_of(method, 25, state=state))  # the last generation of nsga2 is cut short
    extended = search_of(method, 45, state=state)
    assert extended.evaluations == 25
    assert run(extended) == run(search_of(method))
    with pytest.raises(ValueError, match="is of 45 evaluations, not 25; give 45 or more"):
        search_of(method, 25, state=state)


def test_a_search_that_depends_on_its_budget_is_not_extended(tmp_path):
    state = tmp_path / "run.json"
    run(search_of("nsga2", 20, state=state))
    before = state.read_text()
    # of 1,000 candidates the population is 20, of 20 it is 10
    with pytest.raises(ValueError, match=r"with 1000 nsga2 asks for another candidate 11; give 20"):
        search_of("nsga2", 1000, state=state)
    assert state.read_text() == before


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"upper": 6}, r"its upper is \[5.0, 5.0\], not \[6.0, 6.0\];"),
        ({"units": ["mm", "J"]}, r"its units are \['m', 'J'\], not \['mm', 'J'\];"),
        ({"seed": 4, "settings": {"first": 7}}, r"seed is 3, not 4, its settings are not given, "),
    ],
)
def test_what_differs_from_a_state_is_named_with_both_values(other, words, tmp_path):
    state = tmp_path / "run.json"
    begun = search_of(state=state)
    begun.tell(begun.ask(), *measure(begun.ask()))
    with pytest.raises(ValueError, match=words):
        search_of(state=state, **other)


def test_a_state_of_another_search_is_refused(tmp_path):
    state = tmp_path / "run.json"
    begun = search_of(state=state)
    begun.tell(begun.ask(), *measure(begun.ask()))
    with pytest.raises(ValueError, match="its method is 'es', not 'nsga2'"):
        search_of("nsga2", state=state)
    begun.tell(begun.ask(), *measure(begun.ask()))
    state.write_text("{}")
    with pytest.raises(ValueError, match="was changed by another program"):
        begun.tell(begun.ask(), *measure(begun.ask()))
    with pytest.raises(ValueError, match="is not a search"):
        search_of(state=state)
    with pytest.raises(TypeError, match="give a name"):
        search_of(object())
