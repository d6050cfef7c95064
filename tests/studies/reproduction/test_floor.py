"""Multiples of the floor: what `quietarm reproduce` holds against it."""

import pytest
from quietarm.studies.paper import CONDITIONS
from quietarm.studies.reproduction.tables import multiples


@pytest.mark.parametrize("condition", CONDITIONS, ids=lambda c: f"{c.task.plant.name} {c.label}")
def test_nothing_is_below_the_floor(reproduction, condition):
    # Not the gradient, nor anything within the paper's residuals (which are nearly rest).
    found = multiples(reproduction, condition)
    assert min(lower for _, lower, _ in found.values()) > 1
    gradient = [of[0] for (series, _), of in found.items() if series == "gradient, no box"]
    assert gradient[-1] < 1.3  # ten terms are near it: docs/physics.md, 'N = 8 and 10 go lower'
    assert gradient == sorted(gradient, reverse=True)
