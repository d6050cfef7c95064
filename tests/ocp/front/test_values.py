"""Fronts as values: which points stay, what is selected from them, their files."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moves import ARM

import quietarm as qa
from quietarm.ocp import FileFormatError, FrontPoint, Mark, Record, non_dominated
from quietarm.ocp.front.points import has_knee


def _points(*figures):
    """Points of the given (residual, energy); the coefficient tells them apart."""
    return tuple(FrontPoint((float(i), -0.5), r, e) for i, (r, e) in enumerate(figures))


def _front(points, **changes):
    content = {
        "task": ARM,
        "profile": qa.CycloidPolynomial(2),
        "points": points,
        "record": Record("nsga2", {"population": 20, "generations": None}, 0.5, 3, 60),
        "reference": (0.015, 0.25),
        "failed": 2,
        **changes,
    }
    return qa.Front(**content)


def _by_definition(points):
    """Finite, no other at least as good in both and better in one, and the first of its equals."""
    finite = [p for p in points if math.isfinite(p.residual) and math.isfinite(p.energy)]

    def beats(one, other):
        no_worse = one.residual <= other.residual and one.energy <= other.energy
        return no_worse and (one.residual, one.energy) != (other.residual, other.energy)

    kept = {}
    for p in finite:
        if not any(beats(q, p) for q in finite):
            kept.setdefault((p.residual, p.energy), p)
    return tuple(sorted(kept.values(), key=lambda p: p.residual))


values = st.one_of(
    st.floats(0, 1),
    st.sampled_from([0.0, -0.0, 0.25, 0.5, math.nan, math.inf, -math.inf, 5e-324, 1e308]),
)


@given(st.lists(st.tuples(values, values), max_size=25))
def test_the_points_that_stay_are_those_of_the_definition(figures):
    points = _points(*figures)
    assert non_dominated(points) == _by_definition(points)


@pytest.mark.parametrize(("limit", "index"), [(1.9e-4, 0), (2e-4, 1), (math.inf, 2)])
def test_the_cheapest_within_a_residual(limit, index):
    front = _front(_points((1e-4, 0.5), (2e-4, 0.2), (8e-4, 0.1)))
    assert front.cheapest(limit) is front.points[index]
    with pytest.raises(ValueError, match=r"0\.0001"):  # the least there is
        front.cheapest(9.9e-5)


@given(st.lists(st.tuples(st.floats(1e-6, 1e-2), st.floats(0.01, 1.0)), min_size=3, max_size=12))
def test_the_knee_has_the_least_sum_of_shares_whatever_the_ends(figures):
    front = _front(non_dominated(_points(*figures)))
    residual, energy = front.reference
    knee = front.knee()
    least = knee.residual / residual + knee.energy / energy
    for point in front.points:
        assert least <= point.residual / residual + point.energy / energy + 1e-12
    shorter = front.points[: front.points.index(knee) + 2]  # without the cheap end
    assert _front(shorter).knee() == knee


@pytest.mark.parametrize(
    ("energies", "bends"),
    [
        # residuals 0, 1 and 9 mm of 10 mm, energies of 1 J: the sums by hand
        ((0.9, 0.4, 0.3), True),  # 0.9, 0.5, 1.2
        ((0.9, 0.75, 0.3), False),  # 0.9, 0.85, 1.2: less than a tenth below the end
        ((0.3, 0.25, 0.1), False),  # 0.3, 0.35, 1.0: the end is least
        ((0.9, 0.3), False),  # its ends alone
        ((0.9, 0.31, 0.3), False),  # 0.9, 0.41, 1.2: beside the cheap end
    ],
)
def test_a_front_has_a_knee_if_it_bends_by_a_tenth(energies, bends):
    residuals = (0.0, 1e-3, 9e-3) if len(energies) == 3 else (0.0, 9e-3)
    assert has_knee(np.column_stack([residuals, energies]), (10e-3, 1.0)) is bends


figures = st.floats(min_value=-0.0, allow_infinity=False)  # residuals and energies


@given(st.lists(st.tuples(figures, figures), max_size=6), st.integers(0, 2**63), st.floats(0, 1))
@settings(max_examples=20)  # each writes and reads a file
def test_a_front_comes_back_as_it_was(tmp_path_factory, figures, seed, share):
    path = tmp_path_factory.mktemp("front") / "front.json"
    history = (Mark(20, share),)
    points = non_dominated(_points(*figures))
    front = _front(points, history=history).restated(seed=seed, seconds=1.25)
    front.save(path)
    assert qa.Front.load(path) == front
    assert qa.Front.load(path).record.seconds == 1.25
    with pytest.raises(FileFormatError, match="quietarm-front"):
        qa.Plan.load(path)
