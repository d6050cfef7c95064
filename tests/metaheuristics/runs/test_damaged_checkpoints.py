"""Checkpoints that a hand or a disk changed: refused in one line, or harmless; never a crash."""

import copy
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from quietarm.metaheuristics import search
from quietarm.metaheuristics.runs.checkpoint import load_checkpoint, save_checkpoint
from quietarm.ocp import FileFormatError
from small_searches import IMPOSSIBLE, LIMITED, METHODS, SIXTH

TASKS = {"free": SIXTH, "limited": LIMITED["vepso"], "impossible": IMPOSSIBLE["vepso"]}
GONE = object()


def _run(method, task, **options):
    return search(task, method, bound=0.2, population=6, generations=5, **options)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Header and state after three generations, by method and task."""
    path, found = tmp_path_factory.mktemp("whole") / "checkpoint", {}

    def stop(progress):
        if progress.generation == 3:
            raise KeyboardInterrupt

    for method in ("nsga2", "vepso"):
        for name, task in TASKS.items():
            _run(method, task, checkpoint=path, report=stop)
            found[method, name] = load_checkpoint(path)
    return lambda method, name: found[method, name]  # a table would fill pages when a test fails


def _changed(tree, keys, value):
    """A copy with one entry deep inside replaced or gone."""
    tree = copy.deepcopy(tree)
    inner = tree
    for key in keys[:-1]:
        inner = inner[key]
    if value is GONE:
        del inner[keys[-1]]
    else:
        inner[keys[-1]] = value(inner[keys[-1]]) if callable(value) else value
    return tree


def _nan_first(array):
    array = array.astype(float)
    array.flat[0] = np.nan
    return array


PEOPLE = {"nsga2": ("algorithm", "population"), "vepso": ("algorithm", "particles")}
DAMAGE = {
    "algorithm gone": (("algorithm",), GONE),
    "algorithm empty": (("algorithm",), {}),
    "algorithm null": (("algorithm",), None),
    "X gone": (("PEOPLE", "X"), GONE),
    "X null": (("PEOPLE", "X"), None),
    "X short": (("PEOPLE", "X"), lambda X: X[:-1]),
    "X narrow": (("PEOPLE", "X"), lambda X: X[:, :-1]),
    "X flat": (("PEOPLE", "X"), lambda X: X.ravel()),
    "X empty": (("PEOPLE", "X"), lambda X: X[:0]),
    "X texts": (("PEOPLE", "X"), lambda X: X.astype(str)),
    "X complex": (("PEOPLE", "X"), lambda X: X.astype(complex)),
    "X NaN": (("PEOPLE", "X"), _nan_first),
    "X beyond the bound": (("PEOPLE", "X"), lambda X: X + 1.0),
    "F gone": (("PEOPLE", "F"), GONE),
    "F NaN": (("PEOPLE", "F"), _nan_first),
    "F one objective": (("PEOPLE", "F"), lambda F: F[:, :1]),
    "G too wide": (("PEOPLE", "G"), lambda G: np.zeros((len(G), 3))),
    "people a list": (("PEOPLE",), [1, 2]),
    "random_state gone": (("algorithm", "random_state"), GONE),
    "random_state null": (("algorithm", "random_state"), None),
    "random_state empty": (("algorithm", "random_state"), {}),
    "random_state of another kind": (("algorithm", "random_state", "bit_generator"), "MT19937"),
    "random_state text": (("algorithm", "random_state", "state"), "seven"),
    "random_state negative": (("algorithm", "random_state", "state", "inc"), -1),
    "iteration gone": (("algorithm", "iteration"), GONE),
    "iteration zero": (("algorithm", "iteration"), 0),
    "iteration fraction": (("algorithm", "iteration"), 1.5),
    "iteration of a longer history": (("algorithm", "iteration"), 4),
    "evaluations null": (("algorithm", "evaluations"), None),
    "evaluations of another history": (("algorithm", "evaluations"), 7),
    "history gone": (("evaluations",), GONE),
    "history of unequal lengths": (("hypervolume",), lambda shares: shares[:-1]),
    "history falls": (("evaluations",), lambda counts: counts[::-1]),
    "hypervolume NaN": (("hypervolume",), _nan_first),
    "hypervolume above one": (("hypervolume",), lambda shares: shares + 2),
    "failed text": (("failed",), "none"),
    "failed negative": (("failed",), -1),
    "infeasible gone": (("infeasible",), GONE),
    "seconds null": (("seconds",), None),
    "seconds infinite": (("seconds",), math.inf),
}
OWN = {
    "nsga2": {
        "rank gone": (("PEOPLE", "rank"), GONE),
        "rank of another length": (("PEOPLE", "rank"), lambda rank: rank[:-1]),
        "rank NaN": (("PEOPLE", "rank"), lambda rank: rank * np.nan),
        "crowding NaN": (("PEOPLE", "crowding"), lambda crowding: crowding * np.nan),
        "crowding null": (("PEOPLE", "crowding"), None),
        "nobody of rank 0": (("PEOPLE", "rank"), lambda rank: rank + 1),
        "more than the population": (
            ("PEOPLE",),
            lambda people: {name: np.repeat(column, 2, axis=0) for name, column in people.items()},
        ),
    },
    "vepso": {
        "velocities short": (("algorithm", "velocities"), lambda v: v[:, :-1]),
        "velocities NaN": (("algorithm", "velocities"), _nan_first),
        "best_X beyond the bound": (("algorithm", "best_X"), lambda X: X + 1.0),
        "best_merit NaN": (("algorithm", "best_merit"), _nan_first),
        "swarm_best out of range": (("algorithm", "swarm_best"), lambda best: best + 99),
        "swarm_best fraction": (("algorithm", "swarm_best"), lambda best: best + 0.5),
        "archive gone": (("algorithm", "archive"), GONE),
        "archive narrow": (("algorithm", "archive", "X"), lambda X: X[:, :-1]),
        "archive of unequal lengths": (("algorithm", "archive", "F"), lambda F: F[:-1]),
        "archive NaN": (("algorithm", "archive", "F"), _nan_first),
    },
}
CASES = [(method, name) for method in ("nsga2", "vepso") for name in (*DAMAGE, *OWN[method])]


def _keys(method, keys):
    return (*PEOPLE[method], *keys[1:]) if keys[0] == "PEOPLE" else keys


@pytest.mark.parametrize(("method", "name"), CASES)
def test_a_state_that_is_not_whole_is_refused_and_left_as_it_was(tmp_path, whole, method, name):
    keys, value = {**DAMAGE, **OWN[method]}[name]
    header, state = whole(method, "free")
    path = tmp_path / "checkpoint"
    save_checkpoint(path, header, _changed(state, _keys(method, keys), value))
    before, seen = (path.read_bytes(), path.stat().st_mtime_ns), []
    with pytest.raises(FileFormatError, match=r"is not a (whole|valid) checkpoint: ") as caught:
        _run(method, SIXTH, resume=path, checkpoint=path, report=seen.append)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert seen == []
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before


@METHODS
def test_the_same_state_unchanged_goes_on(tmp_path, whole, method):
    path = tmp_path / "checkpoint"
    for name, task in TASKS.items():
        save_checkpoint(path, *whole(method, name))
        assert _run(method, task, resume=path) == _run(method, task)


@METHODS
def test_an_empty_state_is_refused(tmp_path, whole, method):
    path = tmp_path / "checkpoint"
    save_checkpoint(path, whole(method, "free")[0], {})
    with pytest.raises(FileFormatError, match="'algorithm' is missing"):
        _run(method, SIXTH, resume=path)


@METHODS
def test_a_header_that_lacks_something_names_it(tmp_path, whole, method):
    path = tmp_path / "checkpoint"
    header, state = whole(method, "free")
    for name in header:
        save_checkpoint(path, _changed(header, (name,), GONE), state)
        with pytest.raises(FileFormatError, match=f"not a whole checkpoint: '{name}' is missing"):
            _run(method, SIXTH, resume=path)


def _leaves(tree, keys=()):
    """All ways into a nested table, to its tables and to its entries."""
    for name, value in tree.items():
        yield (*keys, name)
        if isinstance(value, dict):
            yield from _leaves(value, (*keys, name))


SCALARS = [None, True, -1, 0, 3, 2**70, 0.5, math.nan, -math.inf, 1e308, "", "free", [], [[1]], {}]
ARRAYS = [
    np.zeros(()), np.zeros(3), np.zeros((6, 6)), np.zeros((0, 6)), np.ones((6, 2), dtype=int),
    np.full(6, np.nan), np.full(6, -np.inf), np.full((2, 6, 6), np.nan),
    np.full((6, 6), np.nan), np.full((6, 2), np.inf), np.array(["a"]), np.array([1j]),
]  # fmt: skip


@METHODS
@given(data=st.data())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_entry_replaced_is_refused_in_one_line_or_harmless(tmp_path, whole, method, data):
    name = data.draw(st.sampled_from(sorted(TASKS)))
    tables = dict(zip(("header", "state"), whole(method, name), strict=True))
    keys = data.draw(st.sampled_from(list(_leaves(tables))[2:]))
    if len(keys) == 1:
        return
    value = data.draw(st.sampled_from([GONE, *SCALARS] + (ARRAYS if keys[0] == "state" else [])))
    path = tmp_path / "checkpoint"
    tables = _changed(tables, keys, value)
    save_checkpoint(path, tables["header"], tables["state"])
    words = ""
    try:
        front = _run(method, TASKS[name], resume=path)
    except ValueError as error:  # and FileFormatError, which is one
        words = str(error)
    if words:
        assert str(path) in words
        assert "\n" not in words
    else:
        assert len(front.history) == 5
        assert np.all(np.isfinite(front.residuals))
