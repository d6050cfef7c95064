"""Cards of problems: nonconvex ranges and active bounds, by hand and of a reference front."""

from math import pi

import pytest

from quietarm.metaheuristics.problems.card import card_of
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, FrontPoint, PointToPoint, Record


def front_of(points, coefficients=(0.1, 0.1)):
    return Front(
        task=PointToPoint(SingleLinkManipulator(), pi / 6, 0.8),
        profile=CycloidPolynomial(2),
        points=tuple(FrontPoint(coefficients, 1e-3 * r, energy) for r, energy in points),
        record=Record("by hand", bound=0.2), reference=(0.01, 1.0),
    )  # fmt: skip


def test_a_front_that_rises_above_its_hull_is_nonconvex_there():
    # convex from 0 to 2 mm; at 3 mm it is above the line from (2, 0.4) to (6, 0.2)
    card = card_of(front_of([(0, 1.0), (2, 0.4), (3, 0.38), (6, 0.2), (8, 0.15)]))
    assert card.nonconvex == (pytest.approx((2e-3, 6e-3)),)
    assert card.nonconvex_share == pytest.approx(0.5)
    assert card.still_falls == pytest.approx(0.05 / 2 / (0.85 / 8))
    assert card.active == ()
    assert card_of(front_of([(0, 1.0), (1, 0.5)], (0.1, -0.2))).active == (2,)
