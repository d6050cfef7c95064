"""What the population objective builds and holds, and that it loses no Ctrl-C."""

from populations import PROFILE, SINGLE_LINK, pi
from quietarm.metaheuristics import PopulationObjective
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
)

# -- builds --


def test_a_faster_mode_gets_more_steps():
    fast = SingleLinkManipulator(omega=30.0)
    assert (
        PopulationObjective(PointToPoint(SINGLE_LINK, pi / 6, 0.8), PROFILE).steps
        == CANDIDATE_STEPS
    )
    # two steps a radian of the fastest mode (ocp.simulation.grid.default_steps)
    assert PopulationObjective(PointToPoint(fast, pi / 6, 0.8), PROFILE).steps == 2 * 30 * 0.8


# -- Ctrl-C --


# -- memory --
