"""What makes a problem hard: on a problem with one minimum, and by hand."""

import numpy as np
import pytest
from quietarm.ocp import evaluate_coefficients, plan_move
from quietarm.studies.contest import landscape
from quietarm.studies.contest.landscape import LEVEL, _correlation, _different, landscape_of
from small_contest import TINY


@pytest.fixture(scope="module")
def found():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(landscape, "STARTS", 6)
        patch.setattr(landscape, "BOXES", (0.1, 2.0))
        return landscape_of(TINY)


def test_the_box_is_held_against_a_plan_of_its_own(found):
    boxes = dict(found.boxes)
    own = plan_move(TINY.task, TINY.profile, residual_limit=LEVEL, bound=TINY.bound)
    wide = plan_move(TINY.task, TINY.profile, residual_limit=LEVEL, bound=2 * TINY.bound)
    assert boxes[2.0] == pytest.approx(wide.energy / own.energy, rel=1e-3)
    assert boxes[2.0] <= 1 + 1e-4
    assert boxes[0.1] is None  # no motion with so small coefficients arrives within 1 mm
    steps = np.linspace(-0.1 * TINY.bound, 0.1 * TINY.bound, 3)
    residuals = [evaluate_coefficients(TINY.task, (a, b)).residual for a in steps for b in steps]
    assert min(residuals) > LEVEL


def test_minima_and_their_correlation_by_hand():
    energies = np.array([1.0, 1.0005, 1.1, 2.0])
    assert _different(energies) == 3
    assert _different(energies[:2]) == 1
    assert _correlation(energies[:2], np.zeros((2, 2))) is None
    steps = np.column_stack([energies - 1, np.zeros(4)])
    assert _correlation(energies, steps) == pytest.approx(1.0)
    assert _correlation(np.array([1.0, 2.0, 3.0]), np.array([[0], [2], [1]])) == pytest.approx(0.5)
