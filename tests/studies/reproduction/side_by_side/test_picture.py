"""The systems as a picture: a row each, a dot for each move."""

import pytest
from quietarm.studies.paper.printed import SINGLE_LINK_SIXTH
from quietarm.studies.reproduction.side_by_side.picture import systems_figure


@pytest.fixture(scope="module")
def figure(reproduction):
    return systems_figure(reproduction.systems)


def dots(ax):
    return [line for line in ax.get_lines() if line.get_marker() not in ("None", "|", "")]


def test_every_figure_that_is_known_is_a_dot(reproduction, figure):
    every = [one for systems in reproduction.systems.values() for one in systems]
    known = sum(one.motion is not None for one in every)
    energies = sum(one.energy is not None for one in every)
    timed = sum(one.seconds is not None for one in every)
    assert [len(dots(ax)) for ax in figure.axes] == [energies, known, known, known, timed]


def test_energies_are_multiples_of_the_floor_and_residuals_shares_of_the_cycloids(
    reproduction, figure
):
    energy, residual, wrong, acceleration, _ = figure.axes
    cycloid, *_, floor = reproduction.systems[SINGLE_LINK_SIXTH]
    first = [dots(ax)[0].get_xdata()[0] for ax in (energy, residual, wrong, acceleration)]
    share = 100 * cycloid.wrong_residual / cycloid.motion.residual
    assert first == pytest.approx([cycloid.energy / floor.energy, 100, share, 1])
    assert min(dot.get_xdata()[0] for dot in dots(energy)) > 0.99
