"""One value of a parameter by all moves: each counts by its swing, and by how sure its fit is.

What a fit does not know, such as friction, the servo or a further mode, draws the frequency of a
small swing aside more than that of a large one: by as much as it moves the tip beside the swing.
So what is random from move to move is taken to grow as the swing gets smaller, and a small swing
neither moves nor widens what a large one told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from quietarm.machine.identify.combine import covering, estimate, groups_of
from quietarm.machine.identify.identified import Estimate, Part


def weigh_moves(name: str, parts: Sequence[Part], swings: Mapping[str, float]) -> Estimate | None:
    """Estimate a parameter from parts of moves together; None if it is as unsure as its value.

    Parameters
    ----------
    name : str
        Of the parameter.
    parts : sequence of Part
        Of the moves, each with a value of it.
    swings : mapping of str to float
        How far the tip swung after each, by the part's recording; any unit.
    """
    recordings = list(dict.fromkeys(part.recording for part in parts))
    amplitudes = np.array([swings[recording] for recording in recordings])
    largest = float(amplitudes.max())
    sizes = largest / np.maximum(amplitudes, 1e-6 * largest + 1e-300)
    estimated = estimate(name, groups_of(parts, name), sizes)
    estimated = _within_all(estimated, parts)
    about_as_large = 0.5  # share of the largest swing
    ranges = [
        part.spread[name]
        for part in parts
        if name in part.spread and swings[part.recording] >= about_as_large * largest
    ]
    estimated = covering(estimated, ranges, ranges)
    return None if estimated.value == 0 or estimated.error >= 1 else estimated


def _within_all(estimated: Estimate, parts: Sequence[Part]) -> Estimate:
    """An estimate whose interval is no wider than those of all moves together.

    Two moves that differ hardly tell by how much moves scatter.
    """
    if len(parts) == 1:
        return estimated
    name = estimated.parameter
    many = 2.0  # deviations
    lows = [part.values[name] - many * part.deviations[name] for part in parts]
    highs = [part.values[name] + many * part.deviations[name] for part in parts]
    low, high = max(estimated.low, min(lows)), min(estimated.high, max(highs))
    return replace(estimated, low=low, high=high)
