"""VEPSO on both plants finds more than chance."""

import moocore
import numpy as np
import pytest
from quietarm.metaheuristics import PAPER_BOX, PopulationObjective, search
from small_searches import HALF, SIXTH


@pytest.mark.parametrize("task", [SIXTH, HALF], ids=["single link", "arm"])
def test_the_swarms_find_more_than_chance_with_as_many_candidates(task):
    bound = PAPER_BOX[task.plant.name]
    front = search(task, "vepso", bound=bound, population=50, generations=60)
    X = np.random.default_rng(0).uniform(-bound, bound, (front.record.evaluations, 6))
    values = PopulationObjective(front.task, front.profile)(X)
    F = np.column_stack([values.residual, values.energy]) / front.reference
    # measured, seeds 0 to 2: 0.84 to 0.86 to 0.80, and 0.56 to 0.61 to 0.53
    assert front.history[-1].hypervolume > moocore.hypervolume(F, ref=[1.0, 1.0]) + 0.02
