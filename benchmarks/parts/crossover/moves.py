"""The thirty random moves of the experiment: drawn by a stated seed and rule, kept in a table.

The rule, written before any result was seen. Every plant has its default parameters and draws six
moves. A joint that turns goes from zero to 20 to 180 degrees, a carriage to 0.05 to 0.5 m; the
duration is 0.9 to 2 periods of the plant's lowest mode; all uniform. The box of the coefficients is
0.2 for the single link and the beam, and 0.5 for others, as in the paper. A move is drawn again
where its front is degenerate: where the gradient's front of six coefficients has no motion within
1 mm, or its cheapest motion leaves less than 2 mm or saves less than 2 per cent of the energy of
the best motion within 1 mm. Of each plant's six moves the first two are for tuning, and so are the
third ones of two plants that the same generator draws: 12 to tune, 18 to test.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

import quietarm as qa
from quietarm.models import Plant
from quietarm.models.joint_motion import LINEAR

SEED = 2026
OF_PLANT = 6
TUNED = 12
WITHIN = 1e-3
"""Residual [m] at which energies are compared."""
LEAST_RESIDUAL = 2e-3
LEAST_SAVING = 0.02


@dataclass(frozen=True)
class Move:
    """A random move.

    Attributes
    ----------
    name : str
        Of its plant and number.
    plant : Plant
        With its default parameters.
    target : float
        Angle [rad] or place [m].
    duration : float
        Seconds.
    bound : float
        Largest absolute coefficient.
    tuning : bool
        Whether settings are tuned on it; else methods are tested on it.
    redrawn : int
        How many moves before it were degenerate.
    """

    name: str
    plant: Plant
    target: float
    duration: float
    bound: float
    tuning: bool
    redrawn: int


def plants() -> tuple[Plant, ...]:
    """The five plants."""
    return (
        qa.SingleLinkManipulator(),
        qa.ArmOnFlexibleLink(),
        qa.DualLinkManipulator(),
        qa.FlexibleBeam(),
        qa.LinearAxis(),
    )


def bound_of(plant: Plant) -> float:
    """The box of the coefficients."""
    narrow = ("single-link", "flexible-beam")
    return 0.2 if plant.name in narrow else 0.5


def first_period(plant: Plant) -> float:
    """Return the period of the plant's lowest mode [s]."""
    frequencies = [
        getattr(plant, name) for name in ("omega", "omega1", "omega2") if hasattr(plant, name)
    ]
    return 2 * pi / min(frequencies)


def candidates(plant: Plant, random: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Targets and durations without end, targets in whole tenths of a degree or millimetres."""
    while True:
        if plant.joint == LINEAR:
            target = round(random.uniform(0.05, 0.5), 3)
        else:
            target = qa.deg(round(random.uniform(20.0, 180.0), 1))
        duration = round(random.uniform(0.9, 2.0) * first_period(plant), 4)
        yield target, duration


def degenerate(plant: Plant, target: float, duration: float) -> bool:
    """Return whether a move has no front to speak of."""
    task = qa.PointToPoint(plant, target, duration)
    try:
        front = qa.epsilon_front(
            task, qa.CycloidPolynomial(6), bound=bound_of(plant), points=10, at=(WITHIN,)
        )
    except qa.QuietarmError:
        return True
    cheapest = min(front.points, key=lambda point: point.energy)
    still = front.least_energy(WITHIN)
    if not np.isfinite(still):
        return True
    saving = 1 - cheapest.energy / still
    return cheapest.residual < LEAST_RESIDUAL or saving < LEAST_SAVING


def draw(seed: int = SEED) -> tuple[Move, ...]:
    """All moves, plant by plant; some of them are drawn again."""
    random = np.random.default_rng(seed)
    third = set(random.choice(len(plants()), TUNED - 2 * len(plants()), replace=False).tolist())
    moves = list[Move]()
    for place, plant in enumerate(plants()):
        stream = candidates(plant, random)
        tuning = 2 + (place in third)
        for number in range(OF_PLANT):
            redrawn = 0
            for target, duration in stream:
                if not degenerate(plant, target, duration):
                    break
                redrawn += 1
            moves.append(
                Move(
                    f"{plant.name}-m{number + 1}",
                    plant,
                    target,
                    duration,
                    bound_of(plant),
                    number < tuning,
                    redrawn,
                )
            )
    return tuple(moves)
