"""Fronts: which points belong to one, the ones with a name, files."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ocp import CycloidPolynomial, FileFormatError
from ocp.front import Front, FrontPoint, Generation, non_dominated


def _points(*pairs):
    return tuple(FrontPoint((float(i),), *pair) for i, pair in enumerate(pairs))


@pytest.fixture
def front(tasks):
    """Four points; the third is far below the line between the ends."""
    return Front(
        task=tasks["arm"],
        profile=CycloidPolynomial(1),
        points=_points((0.001, 0.20), (0.003, 0.19), (0.004, 0.10), (0.010, 0.09)),
        method="by hand",
        settings={"bound": 0.5, "rule": "none"},
        seed=3,
        reference=(0.02, 0.3),
        evaluations=40,
        history=(Generation(20, 0.1), Generation(40, 0.2)),
    )


# -- which points --

pairs = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=30)


@given(pairs=pairs)
def test_a_front_has_just_the_points_that_none_beats(pairs):
    points = [FrontPoint((float(i),), float(r), float(e)) for i, (r, e) in enumerate(pairs)]

    def beaten(p):
        return any(
            q.residual <= p.residual
            and q.energy <= p.energy
            and (q.residual < p.residual or q.energy < p.energy)
            for q in points
        )

    expected = {(p.residual, p.energy) for p in points if not beaten(p)}
    found = [(p.residual, p.energy) for p in non_dominated(points)]
    assert set(found) == expected
    assert len(found) == len(expected)
    assert found == sorted(found)


def test_of_equal_points_the_first_is_kept():
    (kept,) = non_dominated(_points((1.0, 1.0), (1.0, 1.0)))
    assert kept.coefficients == (0.0,)


@pytest.mark.parametrize("broken", [(math.nan, 0.0), (0.0, math.nan), (0.0, -math.inf)])
def test_points_that_are_not_finite_are_left_out(broken):
    found = non_dominated(_points(broken, (1.0, 1.0)))
    assert [(p.residual, p.energy) for p in found] == [(1.0, 1.0)]


# -- points with a name --


def test_stillest_cheapest_and_knee(front):
    assert front.stillest() == front.points[0]
    assert front.cheapest() == front.points[3]
    assert front.knee() == front.points[2]


@pytest.mark.parametrize(("limit", "index"), [(0.001, 0), (0.0035, 1), (0.004, 2), (1.0, 3)])
def test_the_cheapest_within_a_limit(front, limit, index):
    assert front.cheapest(limit) == front.points[index]


def test_a_limit_below_the_stillest_is_named_with_what_there_is(front):
    with pytest.raises(ValueError, match=r"0\.0005 m.*stillest has 0\.001 m"):
        front.cheapest(5e-4)


def test_an_empty_front_has_no_such_points(front):
    empty = replace(front, points=())
    for choose in (empty.stillest, empty.cheapest, empty.knee):
        with pytest.raises(ValueError, match="no point"):
            choose()


def test_residuals_and_energies_in_order(front):
    assert front.residuals.tolist() == [0.001, 0.003, 0.004, 0.010]
    assert front.energies.tolist() == [0.20, 0.19, 0.10, 0.09]
    assert np.all(np.diff(front.energies) < 0)


# -- files --


def test_a_saved_front_loads_equal(front, tmp_path):
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


def test_a_plan_is_not_a_front(front, tmp_path):
    path = tmp_path / "front.json"
    front.save(path)
    document = json.loads(path.read_text())
    path.write_text(json.dumps({**document, "format": "quietarm-plan"}))
    with pytest.raises(FileFormatError, match="not a front: its format is 'quietarm-plan'"):
        Front.load(path)


@pytest.mark.parametrize("key", ["points", "reference", "method", "settings", "profile", "plant"])
def test_a_missing_entry_is_named(front, tmp_path, key):
    path = tmp_path / "front.json"
    front.save(path)
    document = json.loads(path.read_text())
    del document[key]
    path.write_text(json.dumps(document))
    with pytest.raises(FileFormatError, match=f"'{key}' is missing"):
        Front.load(path)
