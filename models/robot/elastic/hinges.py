"""Hinges in place of a beam: where they are, and how far each one gives.

What bends a beam is an integral along it, and hinges are a rule of quadrature: hinges at Gauss's
places, each of which gives as its weight, bend under a load at the tip exactly as the beam does.
Weights that are changed least make the frequencies exact too, which the beam's mass, in rigid
pieces between them, would miss.

Nothing has dimensions: lengths are shares of the beam's, masses of its mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from quietarm.models.beam_modes import beam_modes
from quietarm.models.joint_motion import Array
from quietarm.models.robot.elastic.spectra import spectrum


class Hinges(NamedTuple):
    """Places along a beam, rising, and how far each gives: its angle by a moment of 1."""

    places: Array
    compliances: Array


def hinges_in_the_middle(count: int) -> Hinges:
    """A hinge in the middle of each of equal parts: too stiff, by a share of a part's square."""
    return Hinges((np.arange(count) + 0.5) / count, np.full(count, 1 / count))


@lru_cache(maxsize=64)
def exact_hinges(count: int, ratio: float) -> Hinges:
    """Hinges by which the clamped beam has Euler and Bernoulli's first two frequencies.

    From four hinges on a force at the tip bends it as far as them, too; one hinge has the first
    frequency alone. The compliances are those nearest to Gauss's weights.

    Parameters
    ----------
    count : int
        How many.
    ratio : float
        Mass at the tip, in shares of the beam's.
    """
    ratio = min(ratio, _HEAVIEST)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    places = (nodes + 1) / 2
    weights = weights / 2
    right = min(count, 2)
    wanted = np.array(beam_modes(right, ratio, 0.0).wave_numbers, float) ** 2
    masses = masses_of_chain(places, ratio)
    arms = (1 - places) ** 2
    compliances = weights.copy()
    for _ in range(_MOST_NEWTON):
        squares, shapes = spectrum(np.diag(1 / compliances), masses)
        frequencies = np.sqrt(squares[:right])
        slopes = -((shapes[:, :right].T / compliances) ** 2) / (2 * frequencies[:, None])
        missing = wanted - frequencies
        if count > _FREE:
            slopes = np.vstack([slopes, arms])
            missing = np.append(missing, _OF_A_FORCE - arms @ compliances)
        # of all changes that do it to first order, the one that ends nearest to the weights
        back = weights - compliances
        scaled = slopes * weights
        change, *_ = np.linalg.lstsq(scaled, missing - slopes @ back, rcond=None)
        step = back + weights * change
        compliances = compliances + step
        if np.abs(step).max() < _SETTLED:
            break
    return Hinges(places, compliances)


_HEAVIEST = 1e4
"""Mass at the tip from which on a heavier one changes nothing, in shares of the beam's."""
_FREE = 3
"""Hinges that have to change much for two frequencies, and are left free to."""
_OF_A_FORCE = 1 / 3
"""How far the tip of a beam gives to a force there."""
_MOST_NEWTON = 50
_SETTLED = 1e-13


def masses_of_chain(places: Sequence[float] | Array, ratio: float) -> Array:
    """Mass matrix of the hinges' angles, for small ones: thin pieces between them, and the tip."""
    places = np.asarray(places, float)
    count = len(places)
    arms = 1 - places
    masses = ratio * np.outer(arms, arms)
    ends = [*places, 1.0]
    for number, (begin, end) in enumerate(pairwise(ends), start=1):
        mass = end - begin
        arms = (begin + end) / 2 - places[:number]
        turning = np.full((number, number), mass**2 / 12)
        masses[:number, :number] += mass * (np.outer(arms, arms) + turning)
    assert masses.shape == (count, count)
    return masses
