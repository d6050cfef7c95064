"""Judge moves between the cells of a sweep, without solving anything.

Fixed steps rank random moves, many in one call; CVODES judges those that they rank worst.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp import Plan, PointToPoint
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.rest import REST
from quietarm.ocp.simulation.evaluator import Evaluator
from quietarm.ocp.solvers.problem import first_steps
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.sweep.move_grid import by_plant
from quietarm.views.tips import tip_words

if TYPE_CHECKING:
    from quietarm.studies.sweep.library import MoveLibrary

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Between:
    """Residual and cost of moves between cells: the worst of some random ones, by CVODES.

    Attributes
    ----------
    residual : float
        Largest residual; of uncertain plants with any errors within their ranges.
    excess : float
        Largest share by which a move takes more energy than the cells around it, whose energies are
        interpolated as the coefficients are; 0 where none does.
    of_limits : float
        Peak over limit, of the limit that is kept worst; 0 without limits.
    samples : int
        How many random moves there were.
    tip_unit : str
        Unit of the residual.
    """

    residual: float
    excess: float
    of_limits: float
    samples: int
    tip_unit: str = "m"

    @property
    def keeps_limits(self) -> bool:
        """Return whether all of the moves keep their limits."""
        return self.of_limits <= 1 + OVERRUN

    @property
    def words(self) -> str:
        """All of it in a line."""
        broken = f"limits broken by up to {self.of_limits - 1:.1%}"
        more = f"{self.excess:.2%} more" if self.excess else "no more"
        residual = tip_words(self.residual, self.tip_unit)
        if self.residual < REST:
            residual = f"below {tip_words(REST, self.tip_unit)}"
        return ", ".join(
            [
                f"between the cells: residual {residual}",
                f"{more} energy than the cells around the move",
                *(["limits kept" if self.keeps_limits else broken] if self.of_limits else []),
                f"each the largest of {self.samples} random moves",
            ]
        )

    @property
    def remedy(self) -> str:
        """Words on how moves between the cells come to keep their limits."""
        # a margin is advised that is this much larger than the worst excess of these
        spare = 1.5
        share = ceil(100 * spare * (self.of_limits - 1))
        return f"sweep again with --limit-margin {share}% or on a finer grid"


def assess(library: MoveLibrary) -> Between:
    """The worst of random moves between a library's cells.

    ValueError where none of the moves has coefficients.
    """
    # moves with the largest value by fixed steps that CVODES judges: steps take the corners of
    # the errors, the judge all errors within their ranges
    number_judged = 3
    places = _random_places(library)
    energies = library.energies(places)
    tasks = [library.task(**_named(library, place)) for place in places]
    ranks = _ranks(tasks, library.profile, library.interpolation(places), energies)
    chosen = {k for rank in ranks.values() for k in np.argsort(rank)[-number_judged:]}
    judged = {k: library.plan(**_named(library, places[k])) for k in sorted(chosen)}
    shares = [
        share
        for plan in judged.values()
        for share in plan.motion.exceeded(plan.task.limits, -1).values()
    ]
    return Between(
        residual=max(worst_residual(plan) for plan in judged.values()),
        excess=max(0.0, *(float(plan.energy / energies[k] - 1) for k, plan in judged.items())),
        of_limits=max(shares, default=0.0),
        samples=len(places),
        tip_unit=library.grid.task.plant.tip_unit,
    )


def worst_residual(plan: Plan) -> float:
    """The residual of a plan [m], with any errors within the ranges of its task."""
    return plan.residual if plan.worst is None else max(plan.residual, plan.worst.residual)


def _named(library: MoveLibrary, place: Array) -> dict[str, float]:
    return dict(zip(library.grid.names, place.tolist()))


def _random_places(library: MoveLibrary) -> Array:
    """Random places that have coefficients, those of one plant one after another."""
    # random moves between the cells, by which a library says how good it is
    samples = 100
    # plants of these moves, where parameters are axes: equations are compiled for each
    plants = 10
    # places that are tried for each move: some have no coefficients
    tries = 20
    axes = library.grid.axes
    low, high = np.array([(axis.values[0], axis.values[-1]) for axis in axes]).T
    random = np.random.default_rng(0).uniform(
        low,
        high,
        (tries * samples, len(low)),
    )
    of_plant = np.array([axis.name not in OF_MOVES for axis in axes])
    repeated = random[np.arange(len(random)) % plants]
    random[:, of_plant] = repeated[:, of_plant]
    usable = (place for place in random if library.has(place))
    places = np.array([*islice(usable, samples)])
    if not len(places):
        raise ValueError(
            f"{library.store.path} has no move between its cells that has coefficients"
        )
    if of_plant.any():
        places = places[np.lexsort(places[:, of_plant].T)]
    return places


def _ranks(
    tasks: Sequence[PointToPoint], profile: JointProfile, coefficients: Array, energies: Array
) -> Mapping[str, Array]:
    """Residual, energy over that of the cells, and every limited peak, of each move."""
    rows = list[dict[str, float]]()
    for group in by_plant(tasks):
        first = len(rows)
        rows += _figures(group, profile, coefficients[first : first + len(group)])
    ranks = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return ranks | {"energy": ranks["energy"] / energies}


def _figures(
    tasks: Sequence[PointToPoint], profile: JointProfile, coefficients: Array
) -> list[dict[str, float]]:
    """Return figures by fixed steps for moves of one plant; the energy in joules."""
    # so many times the solver's steps, because a limit may be broken between its nodes
    finer = 3
    steps = finer * first_steps(max(tasks, key=lambda task: task.duration), profile)
    evaluation = Evaluator(tasks, profile, steps)(coefficients)
    columns = {
        "energy": evaluation.energy[:, 0],
        RESIDUAL: evaluation.residual.max(axis=1),
        **evaluation.limited_peaks,
    }
    return [{name: float(column[k]) for name, column in columns.items()} for k in range(len(tasks))]
